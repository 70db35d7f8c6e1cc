"""What can go wrong between a program and its robot."""


class RobotError(Exception):
    """Something was asked for and did not come about; the text is a sentence for people."""


class Unreachable(RobotError):
    """The viewer does not answer, or its answer broke off."""


class Refused(RobotError):
    """The viewer or the robot refused a request."""

    def __init__(self, why: str, status: int = 0) -> None:
        super().__init__(why)
        self.status = status  # of HTTP; 0 = refused later, by the robot
