#!/usr/bin/env python3
"""clang-tidy on the sources of a compile database, as many at a time as there are cores.

clang_tidy.py ROOT BUILD: the sources of ROOT's common, services, tools and lab in BUILD/compile_commands.json, without generated ones.

A source that was found clean is looked at again only when its text after the preprocessor (all its headers with it, comments and macros kept), its
command, .clang-tidy or clang-tidy itself has changed. These verdicts stand beside other programs' caches, each an empty file, named by
a digest of all four in which ROOT has no part, so that they hold in every checkout. Those unused for 30 days go.
"""

import concurrent.futures
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import time

# This check looks at names of included sources, and a unity build includes sources.
CHECKS = "-checks=-bugprone-suspicious-include"
KEEP_S = 30 * 24 * 3600


def cache_folder():
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(base, "lookout", "clang-tidy")


def is_ours(root, source):
    place = re.sub(r"^build/lint/", "", os.path.relpath(source, root))
    return re.match(r"(common|services|tools|lab)/", place) and not re.search(r"/generated[^/]*/", place)


def digest(root, tool, entry):
    """Of everything that decides what clang-tidy says; none where the source does not get through the preprocessor."""
    command = shlex.split(entry["command"])
    preprocess, is_output = ["clang++", "-E", "-CC", "-dD"], False
    for word in command[1:]:
        if is_output:
            is_output = False
        elif word == "-o":
            is_output = True
        elif word != "-c":
            preprocess.append(word)
    result = subprocess.run(preprocess, cwd=entry["directory"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    if result.returncode != 0:
        return None
    prefix = (root + "/").encode()
    told = [tool, " ".join(preprocess).encode().replace(prefix, b""), result.stdout.replace(prefix, b"")]
    return hashlib.sha256(b"\0".join(hashlib.sha256(part).digest() for part in told)).hexdigest()


def look_at(root, build, folder, tool, entry):
    """Whether the source is clean, and what clang-tidy printed; None for a verdict that stood already."""
    key = digest(root, tool, entry)
    verdict = os.path.join(folder, key) if key else None
    if verdict and os.path.exists(verdict):
        with open(verdict, "a", encoding="utf-8"):
            os.utime(verdict)
        return True, None
    result = subprocess.run(["clang-tidy", "--quiet", CHECKS, "-p", build, entry["file"]], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    is_clean = result.returncode == 0
    # Unless it was edited meanwhile.
    if is_clean and verdict and digest(root, tool, entry) == key:
        with open(verdict, "w", encoding="utf-8"):
            pass
    return is_clean, result.stdout.decode(errors="replace") + ("" if is_clean else result.stderr.decode(errors="replace"))


def main():
    root, build = (os.path.abspath(path) for path in sys.argv[1:3])
    folder = cache_folder()
    os.makedirs(folder, exist_ok=True)
    for name in os.listdir(folder):
        path = os.path.join(folder, name)
        try:
            if time.time() - os.path.getmtime(path) > KEEP_S:
                os.remove(path)
        except FileNotFoundError:  # by another checkout at the same time
            pass
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        entries = {entry["file"]: entry for entry in json.load(file) if is_ours(root, entry["file"])}
    if not entries:
        sys.exit(f"{build}: no source to look at")
    tool = subprocess.run(["clang-tidy", "--version"], stdout=subprocess.PIPE, check=True).stdout
    with open(os.path.join(root, ".clang-tidy"), "rb") as file:
        tool += file.read() + CHECKS.encode()
    known, faulty = 0, 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for is_clean, said in pool.map(lambda source: look_at(root, build, folder, tool, entries[source]), sorted(entries)):
            known += said is None
            faulty += not is_clean
            if said:
                print(said, end="", flush=True)
    print(f"{len(entries)} sources, {known} of them looked at before, {faulty} with faults")
    sys.exit(1 if faulty else 0)


if __name__ == "__main__":
    main()
