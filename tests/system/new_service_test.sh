#!/usr/bin/env bash
# A new channel with a new service, as CONTRIBUTING.md has its steps, in a copy of the sources: the toy service `echo` reads POSE and publishes ECHO. Each
# file that it takes outside of its folder is one that CONTRIBUTING.md names, there are no more than ten, and all else (units, lookout-up, scripts, the
# doctor, tests) follows when the copy is configured.
#   new_service_test.sh SOURCE_FOLDER [build]   build: builds the copy in part, too, and runs the tests that say what is missing; minutes
set -euo pipefail
source_folder=$1
work=$(mktemp -d -t new_service.XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
copy=$work/copy
mkdir "$copy"
for name in CMakeLists.txt CMakePresets.json cmake common config deploy lab lcmtypes logs services tests tools; do cp -r "$source_folder/$name" "$copy/"; done
cp "$source_folder"/*.md "$source_folder/LICENSE" "$copy/"
rm -f "$copy"/logs/*.lcmlog
cd "$copy"

add_before() {  # FILE PATTERN TEXT: TEXT before the first line that matches
  grep -q "$2" "$1" || fail "$1 has no line as $2"
  awk -v pattern="$2" -v text="$3" '!is_done && $0 ~ pattern { print text; is_done = 1 } { print }' "$1" >"$work/edited"
  cp "$work/edited" "$1"
}

# --- The folder of the service ---
mkdir services/echo
cat >services/echo/README.md <<'TEXT'
# echo: POSE in, ECHO out
TEXT
cat >services/echo/CMakeLists.txt <<'TEXT'
lookout_library(NAME lookout_echo SOURCES params.cpp service.cpp LINKS lookout_bus lookout_wire PRIVATE_LINKS lookout_config)
lookout_program(NAME lookout-echo SOURCES main.cpp LINKS lookout_echo lookout_runtime)
TEXT
cat >services/echo/params.hpp <<'TEXT'
#pragma once
#include <filesystem>
namespace lookout::echo {
struct Params {
  int num_echoes = 1;
};
Params LoadParams(const std::filesystem::path& config_folder);
}  // namespace lookout::echo
TEXT
cat >services/echo/params.cpp <<'TEXT'
#include "services/echo/params.hpp"

#include "common/config/text_config.hpp"
#include "config/schema/echo.pb.h"
namespace lookout::echo {
Params LoadParams(const std::filesystem::path& config_folder) {
  return {config::Load<config::Echo>(config_folder, "echo.txtpb").num_echoes()};
}
}  // namespace lookout::echo
TEXT
cat >services/echo/service.hpp <<'TEXT'
#pragma once
#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "services/echo/params.hpp"
namespace lookout::echo {
class Service {
 public:
  Service(bus::Bus& bus, const Params& params);
  HealthReport Report() const { return {HealthState::kOk, "", {{"echoes", num_echoes_}}}; }

 private:
  std::int64_t num_echoes_ = 0;
};
}  // namespace lookout::echo
TEXT
cat >services/echo/service.cpp <<'TEXT'
#include "services/echo/service.hpp"

#include "lookout/echo_t.hpp"
#include "lookout/pose_t.hpp"
namespace lookout::echo {
Service::Service(bus::Bus& bus, const Params& params) {
  bus::Subscribe<pose_t>(bus, bus::kPose, [this, &bus, params](const pose_t& pose) {
    echo_t message{};
    message.utime_us = pose.utime_us;
    message.seq = num_echoes_++;
    message.pose_seq.assign(static_cast<std::size_t>(params.num_echoes), pose.seq);
    message.num_echoes = params.num_echoes;
    bus::Publish(bus, bus::kEcho, message);
  });
}
}  // namespace lookout::echo
TEXT
cat >services/echo/main.cpp <<'TEXT'
#include "common/runtime/service_main.hpp"
#include "services/echo/service.hpp"
namespace {
void Run(lookout::runtime::Process& process, const lookout::echo::Params& params) {
  const lookout::echo::Service service(process.bus(), params);
  process.Run([&service] { return service.Report(); });
}
}  // namespace
int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::echo::Params>(
      argc, argv, {.name = "echo", .purpose = "POSE in, ECHO out", .load = lookout::echo::LoadParams, .run = Run});
}
TEXT

# --- The steps of CONTRIBUTING.md ---
cat >lcmtypes/echo_t.lcm <<'TEXT'
package lookout;

struct echo_t {
  int64_t utime_us;  // of the pose
  int64_t seq;
  int32_t num_echoes;
  int64_t pose_seq[num_echoes];
}
TEXT
add_before common/bus/channels.hpp 'Channel kHealth[{]' 'inline constexpr Channel kEcho{"ECHO", "echo_t", "echo", 50, 100, false, true};'
sed -i 's/kOrders, *kHealth,/kOrders, kEcho, kHealth,/' common/bus/channels.hpp
add_before common/bus/services.hpp '^    ServiceRow[{]"plotter"' \
  '    ServiceRow{"echo", "echo", "poses again", 10, "network", "checks the config", "none", {&kPose}},'
cat >config/schema/echo.proto <<'TEXT'
// What comes back: echo.txtpb.
syntax = "proto2";
package lookout.config;

import "config/schema/options.proto";

message Echo {
  optional int32 num_echoes = 1 [default = 1, (min) = 0, (max) = 10];
}
TEXT
add_before config/schema/boat.proto '^import "config/schema/georeferencer.proto"' 'import "config/schema/echo.proto";'
add_before config/schema/boat.proto '^  optional Recorder recorder' '  optional Echo echo = 99 [(may_be_absent) = true];'
add_before tools/replay/stage.cpp '^#include "services/georeferencer/params.hpp"' '#include "services/echo/params.hpp"\n#include "services/echo/service.hpp"'
add_before tools/replay/stage.cpp '^      [{]"segmenter", ' \
  '      {"echo", [](const fs::path& folder) { echo::LoadParams(folder); }, Make<PlainStage<echo::Service, echo::LoadParams>>},'
add_before README.md '^[|] \[lookout-plotter\]' '| [lookout-echo](services/echo/README.md) | POSE | ECHO |'
add_before deploy/README.md '^[|] plotter [|]' '| echo | poses again | none | checks the config | 10 |'
add_before lcmtypes/README.md '^[|] gnss_fix_t [|]' '| echo_t | ECHO | a pose again |'
add_before lcmtypes/README.md '^[|] HEALTH [|]' '| ECHO | echo_t | echo | 50 | 100 | |'
add_before tests/golden/fingerprints.txt '^gnss_fix_t ' 'echo_t 0000000000000000'

# --- What it took ---
{ diff -rq "$source_folder" "$copy" || true; } | sed -n -e "s|^Files .* and $copy/\(.*\) differ\$|\1|p" -e "s|^Only in $copy/\?\([^:]*\): \(.*\)\$|\1/\2|p" |
  grep -v '^services/echo$' | sort >"$work/touched.txt"
[ "$(wc -l <"$work/touched.txt")" -le 10 ] || { cat "$work/touched.txt"; fail "a new channel with a service touches more than ten files"; }
while read -r file; do
  named=${file/echo_t.lcm/<type>_t.lcm}
  named=${named/echo.proto/<name>.proto}
  grep -qF "\`$named\`" CONTRIBUTING.md || fail "CONTRIBUTING.md does not name $named, which a new service touches"
done <"$work/touched.txt"

# --- What follows ---
cmake --preset release >"$work/configure.txt" 2>&1 || { tail -n 30 "$work/configure.txt"; fail "the copy cannot be configured"; }
[[ "$(build/release/bin/lookout-up --list | tr '\n' ' ')" == *"plotter echo ais tracker "* ]] || fail "it does not start where its row says: $(build/release/bin/lookout-up --list)"
grep -q '^ExecStart=.*lookout-echo ' build/release/deploy/systemd/lookout-echo.service || fail "it has no unit"
for made in tools/doctor/config_checks.cpp:echo::LoadParams common/schemas.cpp:Echo::descriptor generated/tests/support/wire_types.hpp:'call(echo_t{})' \
  generated/tests/support/wire_types.hpp:'message.pose_seq.resize(2)' generated/tools/diff/fields.hpp:'"pose_seq"' common/schema.cpp:echo_t; do
  grep -qF "${made#*:}" "build/release/${made%%:*}" || fail "build/release/${made%%:*} does not hold ${made#*:}"
done
ninja -C build/release -t query tools/demo_programs >"$work/demo.txt"
grep -q 'lookout-echo' "$work/demo.txt" || fail "the demo does not build it"
echo "a new channel with a service touched $(wc -l <"$work/touched.txt") files outside of its folder:"
cat "$work/touched.txt"
[ "${2:-}" = build ] || exit 0

ninja -C build/release golden_wire >"$work/build.txt" 2>&1 || { tail -n 30 "$work/build.txt"; fail "golden_wire is not built"; }
if build/release/tests/golden_wire >"$work/golden.txt"; then fail "a wrong fingerprint is accepted"; fi
line=$(grep -oE 'echo_t [0-9a-f]{16}' "$work/golden.txt" | grep -v 0000000000000000 | head -n 1)
sed -i "s/^echo_t .*/$line/" tests/golden/fingerprints.txt
ninja -C build/release -k 0 structure unit_wire unit_diff unit_replay unit_doctor lookout-echo lookout-replay lookout-doctor >"$work/build.txt" 2>&1 ||
  { tail -n 30 "$work/build.txt"; fail "the copy is not built"; }
# The first page is full: who adds a row takes a line from elsewhere, by hand.
export GTEST_FILTER=-Pages.TheFirstPageFitsOnTwoScreens
for test in golden_wire structure unit_wire unit_diff unit_doctor; do
  build/release/tests/$test >"$work/test.txt" 2>&1 || { grep -A5 'Failure\|FAILED' "$work/test.txt" | head -n 60; fail "$test"; }
done
build/release/bin/lookout-echo --config config/demo --check >/dev/null || fail "lookout-echo --check"
echo 'num_echoes: 11' >config/demo/echo.txtpb
for program in echo doctor; do
  code=0; build/release/bin/lookout-$program --config config/demo --check >"$work/check.txt" 2>&1 || code=$?
  [ "$code" -ne 0 ] && grep -q 'echo.txtpb:1: num_echoes: must be at most 10' "$work/check.txt" || { cat "$work/check.txt"; fail "lookout-$program accepts a wrong config"; }
done
rm config/demo/echo.txtpb
position=4338.0000,N,07209.0000,W,0.0,0.0,010726,,,A
printf '$GPRMC,%s\r\n$GPHDT,90.0,T*0C\r\n' "120000.00,A,$position*4D" "120001.00,A,$position*4C" >"$work/log.nmea"
build/release/bin/lookout-replay --config config/demo --in "$work/log.nmea" --out "$work/log.lcmlog" --only navigator --only echo >"$work/replay.txt" 2>&1 ||
  { cat "$work/replay.txt"; fail "the replay of a text log"; }
poses=$(awk '$1 == "POSE" { print $2 }' "$work/replay.txt")
[ "${poses:-0}" -gt 10 ] || { cat "$work/replay.txt"; fail "the replay has no POSE"; }
[ "$(awk '$1 == "ECHO" { print $2 }' "$work/replay.txt")" = "$poses" ] || { cat "$work/replay.txt"; fail "the replay does not run the new service"; }
echo "built, tested, replayed: $poses of POSE, as many of ECHO"
