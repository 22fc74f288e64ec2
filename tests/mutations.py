#!/usr/bin/env python3
"""How strong the tests of a folder are: ./dev mutations FOLDER [NUMBER [SEED]].

Draws lines of code of the folder and changes each: a condition becomes its opposite, std::min becomes std::max, + becomes -, * becomes /, a constant
doubles, a statement is left out. All changes are compiled at once, in a copy of the sources in build/mutations; LOOKOUT_MUTANT in the environment says
which one is in force. For each the unit and property tests of the folder run until one fails; those that need more than 20 s of processor time are left
out. What no test notices either changes nothing that can be seen (only speed, a bound that is never met), or lacks a test.
"""
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TREE = ROOT / "build/mutations/tree"
BUILD = TREE / "build/release"
LONGEST_S = 20.0
OPERAND = r"[\w.]+(?:\[[^\[\]]*\]|\(\))*(?:\.\w+(?:\(\))?)*"
HEADER = """#pragma once
#include <cstdlib>
inline bool IsMutant(int number) {
  static const char* const text = std::getenv("LOOKOUT_MUTANT");
  static const int chosen = text == nullptr ? 0 : std::atoi(text);
  return chosen == number;
}
"""


def closing(text, opening):
    """Index of the parenthesis that closes the one at `opening`; -1: it is on another line."""
    depth = 0
    for i in range(opening, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            return i
    return -1


def changes_of(line, before):
    """Changes of one line: (kind, new text, with IsMutant(@) where it is in force)."""
    changes = []
    if line.lstrip().startswith(("//", "#", "static_assert", "using ", "template", "case ")) or '"' in line or ".reserve(" in line:
        return changes
    code = line.split("  //")[0].rstrip()
    found = re.match(r"\s*(?:\} else )?(?:if|while) \(", code)
    if found:
        end = closing(code, found.end() - 1)
        condition = code[found.end():end]
        if end > 0 and ";" not in condition and not re.search(r"\b(auto|const)\b|[^=!<>]=[^=]", condition):
            changes.append(("opposite", f"{code[:found.end()]}IsMutant(@) != static_cast<bool>({condition}){code[end:]}"))
    for found in re.finditer(r"std::(min|max)\(", code):
        end = closing(code, found.end() - 1)
        if end > 0:
            rest = code[found.end() - 1:end + 1]
            other = "max" if found[1] == "min" else "min"
            changes.append((other, f"{code[:found.start()]}(IsMutant(@) ? std::{other}{rest} : {code[found.start():end + 1]}){code[end + 1:]}"))
    for found in re.finditer(rf"(?<![\w.])({OPERAND}) ([-+*/]) ({OPERAND})(?=[;),])", code):
        if not re.search(r"(\(|, |[^<>=!]= |return )$", code[:found.start(1)]):
            continue
        other = {"+": "-", "-": "+", "*": "/", "/": "*"}[found[2]]
        changes.append((other, f"{code[:found.start(1)]}(IsMutant(@) ? {found[1]} {other} {found[3]} : {found[1]} {found[2]} {found[3]}){code[found.end(3):]}"))
    found = re.match(r"(\s*)constexpr (?!bool|char)([\w:]+) (k\w+)(?: = ([^;{}]*\d[^;{}]*)|\{([^;{}]*\d[^;{}]*)\});", code)
    if found:
        value = found[4] or found[5]
        changes.append(("twice", f"{found[1]}const {found[2]} {found[3]} = IsMutant(@) ? static_cast<decltype({value})>(2 * ({value})) : {value};"))
    is_statement = before.rstrip().endswith((";", "{", "}", ":")) or before.lstrip().startswith("//")
    if is_statement and code.count("{") == code.count("}") and code.count("(") == code.count(")"):
        if re.match(r"\s+(\+\+[\w.]+|[a-z_][\w.]*(?:->[\w.]+|\[[^\]]+\])*(?:\(\))? [-+*|&]?= [^;]*|(?!return|throw|std::move)[\w.:]+(?:->\w+)?\(.*\));$", code):
            indent = len(code) - len(code.lstrip())
            changes.append(("left out", f"{code[:indent]}if (!IsMutant(@)) {code[indent:]}"))
    return changes


def candidates(folder):
    """All changes of the folder's sources: (file, line number, kind, new text)."""
    found = []
    for file in sorted((ROOT / folder).rglob("*.cpp")) if (ROOT / folder).is_dir() else [ROOT / folder]:
        if file.name == "main.cpp":
            continue
        lines = file.read_text().split("\n")
        for number, line in enumerate(lines, 1):
            found += [(str(file.relative_to(ROOT)), number, kind, text) for kind, text in changes_of(line, lines[number - 2])]
    return found


def copy_tree():
    TREE.mkdir(parents=True, exist_ok=True)
    recordings = TREE.parent / "shared"
    if not recordings.is_symlink():
        recordings.symlink_to(ROOT.parent / "shared")
    names = subprocess.check_output(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, text=True).split("\n")
    for name in filter(None, names):
        source, copy = ROOT / name, TREE / name
        if source.is_file() and not (copy.is_file() and copy.read_bytes() == source.read_bytes()):
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
    (TREE / "mutant.hpp").write_text(HEADER)


def write(mutants):
    """Writes the changed files, with the line numbers of the sources."""
    by_file = {}
    for index, (file, number, _, text) in enumerate(mutants, 1):
        by_file.setdefault(file, []).append((number, text.replace("@", str(index))))
    for file, changed in by_file.items():
        lines = (ROOT / file).read_text().split("\n")
        for number, text in changed:
            lines[number - 1] = text
        (TREE / file).write_text('#include "mutant.hpp"\n#line 1\n' + "\n".join(lines))


def tests_of(folder):
    """Names and time limits of the unit and property tests that are labelled with the folder, with what it lies in or with what lies in it."""
    description = subprocess.check_output(["ctest", "--test-dir", BUILD, "--show-only=json-v1"], text=True)
    names = []
    for test in json.loads(description)["tests"]:
        labels = {label for one in test["properties"] if one["name"] == "LABELS" for label in one["value"]}
        is_of_folder = any(folder == one or folder.startswith(one + "/") or one.startswith(folder + "/") for one in labels)
        if is_of_folder and labels & {"unit", "property"}:
            names.append(test["name"])
    return names


def run(test, mutant, timeout_s):
    """@return whether it passes, and which case of it failed first"""
    environment = {**os.environ, "LOOKOUT_MUTANT": str(mutant), "GTEST_FAIL_FAST": "1"}
    command = ["ctest", "--test-dir", BUILD, "-R", f"^{test}$", "--output-on-failure", "--timeout", str(timeout_s)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, errors="replace")
    failed = re.search(r"\[  FAILED  \] ([\w/.]+)", done.stdout)
    return done.returncode == 0, failed[1] if failed else "crash or time"


def draw(folder, number, seed):
    """Draws lines, at most one change of each, that compile, and builds the tests with them. @return the changes"""
    left = candidates(folder)
    random.Random(seed).shuffle(left)
    # By turns of each sort: half of all lines are statements.
    sorts = {"opposite": 0, "twice": 1, "left out": 2}
    turns = {}
    for one in left:
        turns.setdefault(sorts.get(one[2], 3), []).append(one)
    left = [one for _, _, one in sorted((turn, sort, one) for sort, all_of_sort in turns.items() for turn, one in enumerate(all_of_sort))]
    mutants = []
    while True:
        while left and len(mutants) < number:
            one = left.pop(0)
            if all(one[:2] != other[:2] for other in mutants):
                mutants.append(one)
        copy_tree()
        write(mutants)
        subprocess.run(["cmake", "--preset", "release"], cwd=TREE, check=True, stdout=subprocess.DEVNULL)
        targets = [test for test in tests_of(folder.rsplit(".cpp", 1)[0]) if (BUILD / "build.ninja").read_text().find(f"\nbuild {test}:") >= 0]
        built = subprocess.run(["ninja", "-C", BUILD, "-j", str(os.cpu_count()), "-k", "0", *targets], capture_output=True, text=True)
        if built.returncode == 0:
            return mutants
        wrong = {(file, int(line)) for file, line in re.findall(r"([\w./-]+\.cpp):(\d+):\d+: error", built.stdout)}
        # What must be known to the compiler is no constant to change: it is told where it is used, and by its name.
        fixed = set(re.findall(r"::(k\w+)\W? was not (?:initialized|declared)", built.stdout))
        kept = [one for one in mutants if not any(file.endswith(one[0]) and line == one[1] for file, line in wrong)]
        kept = [one for one in kept if one[2] != "twice" or re.search(r" (k\w+) = ", one[3])[1] not in fixed]
        if len(kept) == len(mutants):
            sys.exit(built.stdout[-4000:])
        mutants = kept


def main():
    folder = sys.argv[1].rstrip("/")
    number = int(sys.argv[2]) if len(sys.argv) > 2 else 12
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    mutants = draw(folder, number, seed)
    tests = tests_of(folder.rsplit(".cpp", 1)[0])
    seconds = {}
    wall_s = {}
    for test in tests:
        start_s, before = time.monotonic(), os.times()
        passes, _ = run(test, 0, 300)
        wall_s[test], after = time.monotonic() - start_s, os.times()
        seconds[test] = after.children_user - before.children_user + after.children_system - before.children_system
        if not passes:
            sys.exit(f"{test} fails without any change")
    tests = sorted((test for test in tests if seconds[test] <= LONGEST_S), key=seconds.get)
    num_caught = 0
    for index, (file, line, kind, _) in enumerate(mutants, 1):
        caught = ""
        for test in tests:
            passes, case = run(test, index, int(max(20.0, 5.0 * wall_s[test])))
            if not passes:
                caught = f"{test} {case}"
                break
        num_caught += 1 if caught else 0
        source = (ROOT / file).read_text().split("\n")[line - 1].strip()
        print(f"{'caught' if caught else 'NOT CAUGHT'}  {file}:{line}  {kind}: {source[:110]}  {caught}", flush=True)
    print(f"{folder}: {num_caught} of {len(mutants)} caught, seed {seed}, by {len(tests)} tests")


if __name__ == "__main__":
    main()
