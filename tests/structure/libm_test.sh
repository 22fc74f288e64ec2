#!/bin/sh
# Which functions of the C library's mathematics compiled code calls, also through Eigen's templates: none whose result depends on the processor.
#   libm_test.sh NM LIBRARY...     exit code 1 where a library calls one
# What IEEE 754 fixes (sqrt, fmod, nearbyint, lround, floor ...) may be called.
set -eu
nm=$1
shift
forbidden='(a?(sin|cos|tan)h?|atan2|sincos|exp(2|10|m1)?|log(2|10|1p)?|pow|hypot|cbrt|erfc?|[lt]gamma|fma)[fl]?'
failed=0
for library in "$@"; do
  symbols=$("$nm" --undefined-only --no-demangle "$library" | awk '$1 == "U" { sub(/@.*/, "", $2); print $2 }' | sort -u)
  [ -n "$symbols" ] || { echo "no symbols in $library"; exit 1; }
  called=$(echo "$symbols" | grep -Ex "$forbidden|_ZGV.*|.*GeographicLib.*" || true)
  if [ -n "$called" ]; then
    echo "$library calls" $called
    failed=1
  fi
done
exit $failed
