"""Checks schema.json in a folder with the jsonschema package: it is a valid schema, accepts good*.json and
refuses bad*.json. Called by scene_schema_test.cpp."""

import json
import pathlib
import sys

import jsonschema


def read(path):
    # utf-8-sig, because a scene may begin with a byte order mark.
    return json.loads(path.read_text(encoding="utf-8-sig"))


def main(folder):
    schema = read(folder / "schema.json")
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong = 0
    for path in sorted(folder.glob("good*.json")):
        for error in validator.iter_errors(read(path)):
            wrong += 1
            print(f"{path.name}: refused at {error.json_path}: {error.message[:300]}")
    for path in sorted(folder.glob("bad*.json")):
        if validator.is_valid(read(path)):
            wrong += 1
            print(f"{path.name}: accepted")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
