#!/usr/bin/env bash
# What the pages say of command lines, against what the programs say of themselves: every option that stands behind a program's name in a page is one
# of that program, and every option of a program stands in its page.
#   options_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
export LC_ALL=C  # a range of letters is that of the locale: in Turkish, [a-z] has no w
source_folder=$1
bin=$2/bin
num_faults=0
fault() { echo "FAILED: $*"; num_faults=$((num_faults + 1)); }

declare -A options_of
for program in "$bin"/lookout-*; do
  if [ -L "$program" ]; then continue; fi  # an old name
  name=$(basename "$program")
  help=$("$program" --help 2>&1)
  # lookout-log has commands with options of their own.
  for command in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p' <<<"$help"); do help+=$'\n'$("$program" "$command" --help 2>&1); done
  # The page has modes with options of their own.
  for mode in $(grep -oE -- 'With --log|with --link' <<<"$help" | grep -oE -- '--[a-z]+'); do help+=$'\n'$("$program" "$mode" . --help 2>&1); done
  options_of[$name]=" $(grep -oE -- '(^|[ ,[])--[a-z][a-z0-9-]*' <<<"$help" | grep -oE -- '--[a-z0-9-]+' | sort -u | tr '\n' ' ') "
done
[ ${#options_of[@]} -ge 14 ] || fault "only ${#options_of[@]} programs in $bin"

# Words behind a program's name, up to another command or the end of the line.
num_uses=0
while IFS=: read -r file line text; do
  while [[ $text =~ lookout-([a-z0-9]+)(.*) ]]; do
    name=lookout-${BASH_REMATCH[1]} rest=${BASH_REMATCH[2]}
    own=${rest%%lookout-[a-z]*}
    own=${own%%;*}
    own=${own%%apt-get*}
    text=$rest
    [ -n "${options_of[$name]:-}" ] || continue
    for option in $(grep -oE -- '(^|[] `[(])--[a-z][a-z0-9-]*' <<<"$own" | grep -oE -- '--[a-z0-9-]+' || true); do
      num_uses=$((num_uses + 1))
      [[ ${options_of[$name]} == *" $option "* ]] || fault "${file#"$source_folder"/}:$line: $name has no $option"
    done
  done
done < <(grep -nE 'lookout-[a-z0-9]+.*--' "$source_folder"/*.md "$source_folder"/{deploy,lcmtypes,services/*,tools/*,lab/*}/README.md)
[ "$num_uses" -gt 50 ] || fault "only $num_uses options are used in the pages"

for name in "${!options_of[@]}"; do
  page=$source_folder/tools/${name#lookout-}/README.md
  [ -e "$page" ] || page=$source_folder/lab/${name#lookout-}/README.md
  [ -e "$page" ] || page=$source_folder/services/${name#lookout-}/README.md
  [ "$name" = lookout-up ] && page=$source_folder/deploy/README.md
  [ -e "$page" ] || { fault "$name has no page"; continue; }
  for option in ${options_of[$name]}; do
    # The page of the root says what every program has.
    case $option in --help | --version | --config | --check | --lcm-url) continue ;; esac
    grep -qE -- "(^|[^a-z-])$option([^a-z-]|$)" "$page" || fault "${page#"$source_folder"/} does not tell of $option of $name"
  done
done
[ "$num_faults" -eq 0 ]
