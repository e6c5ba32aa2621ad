#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Makes the man page of a tool of what its --help says. Usage: man_page.sh PATH_OF_TOOL >TOOL.1
set -eu
LC_ALL=C
export LC_ALL
version=$("$1" --version)
"$1" --help | awk -v tool="$(basename "$1")" -v version="$version" '
  function roff(text)
  {
      gsub(/\\/, "\\e", text)
      gsub(/-/, "\\-", text)
      return text ~ /^[.'"'"']/ ? "\\&" text : text
  }
  { line[NR] = $0 }
  END {
      split(version, words, " ")
      printf ".TH %s 1 \"\" \"refract %s\" \"User Commands\"\n", toupper(tool), words[2]
      name = line[1]
      sub(/\.$/, "", name)
      printf ".SH NAME\n%s \\- %s%s\n", roff(tool), tolower(substr(name, 1, 1)), roff(substr(name, 2))
      for (usage = 1; line[usage] !~ /^Usage: /; )
          usage++
      printf ".SH SYNOPSIS\n.B %s\n%s\n.SH DESCRIPTION\n", roff(tool), roff(substr(line[usage], length("Usage: " tool " ") + 1))
      for (i = 1; i < usage; i++) {             # examples are indented, and stay lines
          example = line[i] ~ /^ /
          if (example != wasExample)
              print example ? ".PP\n.nf" : ".fi"
          wasExample = example
          print line[i] == "" ? ".PP" : roff(line[i])
      }
      if (wasExample)
          print ".fi"
      for (i = usage + 1; i <= NR; i++) {
          if (line[i] ~ /^[A-Z][a-z ]*:$/) {
              heading = toupper(line[i])
              sub(/:$/, "", heading)
              print ".SH " heading
          } else if (line[i] ~ /^  [^ ]/) {     # what it is called, and from the column of the others what it is
              at = match(substr(line[i], 3), /   */)
              print ".TP\n.B " roff(at ? substr(line[i], 3, at - 1) : substr(line[i], 3))
              if (at)
                  print roff(substr(line[i], 3 + at + RLENGTH - 1))
          } else if (line[i] != "") {
              sub(/^ */, "", line[i])
              print roff(line[i])
          }
      }
  }'
