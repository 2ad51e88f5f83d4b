"""Compares what the example solve.c prints with the JSON of ``whipcord solve``: all numbers must have the same bits."""

import json
import sys


def main() -> None:
    """Reads both files and fails at the first difference."""
    with open(sys.argv[1], encoding="utf-8") as file:
        answer = json.load(file)
    with open(sys.argv[2], encoding="utf-8") as file:
        lines = [line.rsplit(" ") for line in file.read().splitlines()]
    tip = answer["disks"][-1] if "disks" in answer else answer["shape"][-1]
    expected = [*tip["position"], *tip["orientation"]]
    found = [float(number) for number in lines[0][1:]]
    if found != expected:
        sys.exit(f"tip: {found} is not {expected}")
    cables = {cable["name"]: cable["tension"] for cable in answer["cables"]}
    tensions = {line[0]: float(line[1]) for line in lines[1:]}
    if tensions != cables:
        sys.exit(f"tensions: {tensions} are not {cables}")


main()
