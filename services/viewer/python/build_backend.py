"""Makes the package for pip (PEP 517, 660) from the standard library alone: `pip install ./services/viewer/python` works offline."""
import base64
import hashlib
import pathlib
import re
import tarfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r'^__version__ = "(.+)"$', (HERE / "luminav/__init__.py").read_text(), re.MULTILINE)[1]
INFO = f"luminav-{VERSION}.dist-info"
METADATA = f"""Metadata-Version: 2.1
Name: luminav
Version: {VERSION}
Summary: Drives a Luminav robot over its HTTP interface
License: BSD-3-Clause
Requires-Python: >=3.9
"""


def _wheel(folder, files):
    name = f"luminav-{VERSION}-py3-none-any.whl"
    files[f"{INFO}/METADATA"] = METADATA.encode()
    files[f"{INFO}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: luminav\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    record = ""
    with zipfile.ZipFile(pathlib.Path(folder, name), "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            archive.writestr(path, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(data)}\n"
        archive.writestr(f"{INFO}/RECORD", record + f"{INFO}/RECORD,,\n")
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    sources = sorted(path for path in (HERE / "luminav").iterdir() if path.is_file())
    return _wheel(wheel_directory, {f"luminav/{path.name}": path.read_bytes() for path in sources})


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return _wheel(wheel_directory, {"luminav.pth": f"{HERE}\n".encode()})


def build_sdist(sdist_directory, config_settings=None):
    name = f"luminav-{VERSION}.tar.gz"
    with tarfile.open(pathlib.Path(sdist_directory, name), "w:gz") as archive:
        for path in ["pyproject.toml", "build_backend.py", *sorted(HERE.glob("luminav/*.*"))]:
            archive.add(HERE / path, f"luminav-{VERSION}/{(HERE / path).relative_to(HERE)}")
    return name
