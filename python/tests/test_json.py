"""Validates what commands print with --json against docs/raymap.schema.json."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest
from conftest import ROOT
from helpers import load

SCHEMA = json.loads(Path(ROOT, "docs/raymap.schema.json").read_text())
# The exit code, and a command. Each runs in the folder that those before it have filled.
COMMANDS = """
0 example -o scan.ply --holes
0 generate ball.ply -o ball.npz --resolution 12 --json
0 generate scan.ply -o scan.vdb --resolution 24 --sign paths --sampling paper --close-holes --json
0 generate ball_%d.ply -o ball_%d.vdb --resolution 12 --frames 1:2 --json
0 generate ball.ply -o sign.npz --resolution 12 --sign none --json
0 generate scan.ply -o report.npz --resolution 12 --report -
0 generate ball.ply -o none.npz --resolution 12 --sign none --report -
0 generate ball.ply -o band.vdb --resolution 272 --band 3 --json
0 generate ball.ply -o winding.npz --resolution 12 --winding winding.npy --triangle-ids ids.npy --json
0 info ball.ply --json
0 info scan.ply --json
0 info scan.ply --fast --json
0 info ball.npz --json
0 info band.vdb --json
0 info winding.npy --json
0 info ids.npy --json
3 info ball.ply scan.vdb notes.ply --json
0 check ball.ply --json
3 check ball.ply scan.ply notes.ply --json
11 check scan.ply --fast --json
0 query ball.ply points.csv -o query.npz --json
0 query ball.ply points.csv -o query.npz --arrays closest --max-distance 1 --unsigned --json
0 query ball.npz points.csv -o query.npz --arrays distance,gradient --json
0 sample scan.ply -o sample.npz --count 1000 --normalize --json
0 mesh scan.vdb -o mesh.ply --json
0 mesh ball.ply -o mesh.stl --resolution 12 --recenter --json
0 repair scan.ply -o solid.stl --resolution 24 --height 80 --up z --unit mm --json
0 repair scan.ply -o solid.ply --resolution 60 --shell 0.3 --drain-hole 0.2 --drop-smaller 0.1 --json
0 repair ball.ply -o solid.3mf --fit 1 1 1 --remesh --resolution 24 --tolerance 0.1 --triangles 100 --json
3 repair ball.ply notes.ply scan.ply -o repaired/ --resolution 24 --json
0 repair ball.ply -o half.ply --cut-plane 0 0 1 0.1 --split --json
3 generate ball.ply notes.ply -o fields/ --resolution 12 --json
0 simplify ball.ply -o small.ply --triangles 100 --json
3 simplify ball.ply notes.ply -o simplified/ --tolerance 0.01 --json
0 compare ball.npz ball.npz --json
0 compare winding.npy winding.npy --as winding --json
0 devices --json
""".strip().splitlines()


def closed(schema: object) -> object:
    """Returns a schema that allows no key but those that it describes, so that a key without a description is found."""
    if isinstance(schema, list):
        return [closed(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    inner = {key: closed(value) for key, value in schema.items()}
    return inner | ({"additionalProperties": False} if schema.get("type") == "object" else {})


def validator(command: str, schema: object = None):
    jsonschema = load("jsonschema")
    schema = schema or closed(SCHEMA)
    return jsonschema.Draft202012Validator({**schema, "$ref": f"#/$defs/{command}"})


def test_commands_print_what_the_schema_says(end_raymap) -> None:
    load("jsonschema").Draft202012Validator.check_schema(SCHEMA)
    shutil.copy("ball.ply", "ball_1.ply")
    shutil.copy("ball.ply", "ball_2.ply")
    Path("notes.ply").write_text("no mesh")
    Path("points.csv").write_text("x,y,z\n0,0,0\n1,1,1\nnan,0,0\n")
    names = set()
    for line in COMMANDS:
        code, *words = shlex.split(line)
        out = end_raymap(*words, code=int(code)).stdout
        if words[0] == "example":
            continue
        name = words[0] + "_report" * ("--report" in words)
        names.add(name)
        for text in out.splitlines() if words[0] == "check" else [out]:  # Nothing else stands there.
            errors = [error.message for error in validator(name).iter_errors(json.loads(text))]
            assert not errors, (line, errors)
    commands = re.search(r"^\| `--json` \|.*\| (.*) \|$", Path(ROOT, "docs/dev/option_table.md").read_text(), re.MULTILINE)[1]
    assert names == {*commands.split(", "), "generate_report"} == {name for name in SCHEMA["$defs"] if name.islower()}


def test_the_test_of_a_gpu_prints_what_the_schema_says(end_raymap) -> None:
    if len(json.loads(end_raymap("devices", "--json").stdout)["devices"]) == 1:
        pytest.skip("there is no GPU, and none in software")
    made = json.loads(end_raymap("devices", "--test", "vulkan:0", "--json").stdout)
    assert made["tests"][0]["checks"]
    validator("devices").validate(made)


def test_a_planted_key_is_found(end_raymap) -> None:
    made = json.loads(end_raymap("info", "ball.ply", "--json").stdout)
    for key in made:
        assert not validator("info").is_valid({k: v for k, v in made.items() if k != key}), key
    assert not validator("info").is_valid(made | {"undescribed": 1})
    assert not validator("info").is_valid(made | {"verdict": made["verdict"] | {"undescribed": 1}})
    assert not validator("info").is_valid(made | {"watertight": 1})
    # A program that has the schema of an earlier version accepts the keys of a later one.
    assert validator("info", SCHEMA).is_valid(made | {"undescribed": 1})


def test_errors_go_to_stderr(end_raymap) -> None:
    for words in ("info nix.ply --json", "generate nix.ply -o nix.vdb --json", "compare nix.vdb nix.vdb --json"):
        ended = end_raymap(*words.split(), code=4)
        assert ended.stdout == "" and ended.stderr.startswith("raymap: error: nix."), words
