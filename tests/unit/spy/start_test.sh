#!/bin/sh
# The command line of lookout-spy, without a display.
set -u
spy=$1
failures=0
check() {  # EXPECTED_CODE PIECE_OF_OUTPUT COMMAND...
  expected=$1
  piece=$2
  shift 2
  output=$("$@" 2>&1)
  code=$?
  case $output in
    *"$piece"*) ;;
    *) echo "FAILED: $* does not say '$piece': $output"; failures=1 ;;
  esac
  [ "$code" -eq "$expected" ] || { echo "FAILED: $* ends with $code instead of $expected"; failures=1; }
}
unset DISPLAY
check 0 "lookout-spy 0." "$spy" --version
check 0 "--lcm-url URL" "$spy" --help
check 2 "unknown option: --vieuw" "$spy" --vieuw
check 2 "--lcm-url needs an address" "$spy" --lcm-url
# Either the packages that it needs at run time are named, or the display that is missing.
check 1 "lookout-spy: " "$spy" --lcm-url=udpm://239.255.76.67:7667 --view
# A copy without its archives says so.
folder=$(mktemp -d)
mkdir "$folder/bin"
cp "$spy" "$folder/bin/"
check 1 "lookout-types.jar and lookout-spy.jar are not beside" "$folder/bin/lookout-spy"
rm -r "$folder"
exit $failures
