# cmake -DFOLDER=... -P bound_decoding.cmake: bounds the decoders that lcm-gen 1.3.1 has written into FOLDER.
#
# They make room for as many elements as a message claims before they look whether it has them: a datagram of 100 bytes
# takes 2 GB. A text of length 0 throws, and one with a zero inside is not encoded as long as it says. Every element takes
# a byte at least, so no count may exceed the bytes left.
# And no number on the wire is infinite or none at all: whoever reads one need not look for himself.
file(GLOB_RECURSE HEADERS ${FOLDER}/*.hpp)
foreach(header ${HEADERS})
  file(READ ${header} text)
  string(REGEX REPLACE "( +)(this->[a-z_]+\\.resize\\((this->[a-z_]+)\\);)"
         "\\1if(\\3 < 0 || \\3 > maxlen - pos) return -1;\n\\1\\2" text "${text}")
  string(REGEX REPLACE "if\\((__[a-z_]+) > maxlen - pos\\) return -1;"
         "if(\\1 < 1 || \\1 > maxlen - pos || memchr((const char*)buf + offset + pos, 0, \\1) != (const char*)buf + offset + pos + \\1 - 1) return -1;"
         text "${text}")
  string(REGEX REPLACE
         "(__(double|float)_decode_array\\([^,]+, [^,]+, [^,]+, ([^,]+), ([^)]+)\\);\n( +)if\\(tlen < 0\\) return tlen; else pos \\+= tlen;)"
         "\\1\n\\5for(int i = 0; i < \\4; i++) if(!__builtin_isfinite((\\3)[i])) return -1;" text "${text}")
  file(WRITE ${header} "${text}")
endforeach()
