"""The reference pages of the site, made of what the program itself says of its types, its scene files and its commands."""

import html
import json
import re
import subprocess


class Program:
    """Asks the program; every answer that is not given is an error."""

    def __init__(self, path):
        self.path = path

    def text(self, *arguments):
        done = subprocess.run([self.path, *arguments], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"'{self.path} {' '.join(arguments)}' ended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def types(self):
        return json.loads(self.text("nodes", "--json"))

    def schema(self):
        return json.loads(self.text("schema"))

    def commands(self):
        """The names of the commands, in the order of the help."""
        listed = re.search(r"Subcommands:\n((?:  .*\n)+)", self.text("--help"))
        if listed is None:
            raise RuntimeError(f"'{self.path} --help' lists no commands")
        return re.findall(r"^  ([a-z]\S*)", listed[1], re.MULTILINE)


def escaped(text):
    """Text as it is, in a place where Markdown would read marks; names in back quotes stay names."""
    parts = re.split(r"(`[^`]*`)", text)
    for i in range(0, len(parts), 2):
        parts[i] = re.sub(r"([\\*_\[\]#|])", r"\\\1", html.escape(parts[i], quote=False))
    return "".join(parts).replace("\n", " ")


def code(value):
    return "`" + json.dumps(value, ensure_ascii=False).replace("|", "\\|") + "`"


def limits(low, above, high):
    """The range of a number in words."""
    if above is not None and high is not None:
        return f"above {above:g}, at most {high:g}"
    if above is not None:
        return f"above {above:g}"
    if low is not None and high is not None:
        return f"{low:g} to {high:g}"
    if low is not None:
        return f"at least {low:g}"
    return f"at most {high:g}" if high is not None else ""


def parameter_rows(parameters, prefix=""):
    rows = []
    for p in parameters:
        kind = p["kind"] + (f" [{p['unit']}]" if p.get("unit") else "")
        facts = [limits(p.get("min"), p.get("above"), p.get("max"))]
        facts += ["may change during a run"] if p.get("live") else []
        facts += ["may be keyframes"] if p.get("animated") else []
        doc = escaped(p["doc"])
        doc += "".join(f"<br>`{name}`: {escaped(text)}" for name, text in p.get("choices", {}).items())
        default = code(p["default"]) if p.get("default") is not None else ""
        rows.append((f"`{prefix}{p['name']}`", escaped(kind), default, "; ".join(f for f in facts if f), doc))
        rows += parameter_rows(p.get("parameters", []), f"{prefix}{p['name']}.")
    return rows


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def parameter_section(rows):
    if not rows:
        return ""
    return "## Parameters\n\n" + table(("name", "kind", "default", "allowed", "what it is"), rows) + "\n"


def origin(source):
    return "" if source == "weir" else f" It comes from the {escaped(source)}."


def node_page(name, node, modules):
    text = f"# {name}\n\n{escaped(node['doc'])}{origin(node['source'])}\n\n"
    if node["inputs"]:
        rows = [(f"`{p['name']}`", p["type"], "any number" if p["many"] else "one",
                 "yes" if p["required"] else "", escaped(p["doc"])) for p in node["inputs"]]
        text += "## Inputs\n\n" + table(("name", "type", "links", "required", "what it is"), rows) + "\n"
    if node["outputs"]:
        rows = [(f"`{p['name']}`", p["type"], escaped(p["doc"])) for p in node["outputs"]]
        text += "## Outputs\n\n" + table(("name", "type", "what it is"), rows) + "\n"
    text += parameter_section(parameter_rows(node["parameters"]))
    if "family" in node:
        rows = [(f"`{m['name']}`", f"[{m['type']}](../modules/{m['type']}.md)" + ("" if m["enabled"] else " (disabled)"),
                 escaped(modules[m["type"]]["doc"])) for m in node["modules"]]
        text += f"## Modules\n\nThey run in this order in each step.\n\n{table(('name', 'type', 'what it does'), rows)}\n"
        present = {m["type"] for m in node["modules"]}
        rows = [(f"[{n}](../modules/{n}.md)", escaped(m["doc"])) for n, m in modules.items()
                if m["family"] == node["family"] and n not in present]
        if rows:
            text += "These may take the place of one, or be inserted:\n\n" + table(("type", "what it does"), rows)
    return text


def module_page(name, module):
    text = f"# {name}\n\n{escaped(module['doc'])}{origin(module['source'])}\n\n"
    text += f"A module of the family {module['family']}.\n\n"
    return text + (parameter_section(parameter_rows(module["parameters"])) or "It has no parameters.\n")


def index_page(types):
    nodes = [(f"[{n}](nodes/{n}.md)", escaped(t["doc"])) for n, t in types["nodes"].items()]
    modules = [(f"[{n}](modules/{n}.md)", escaped(t["doc"])) for n, t in types["modules"].items()]
    return ("# Reference\n\nThese pages are made from the program when the site is built: they say what `weir nodes`, "
            "`weir schema` and `weir COMMAND --help` say.\n\n"
            "See also [the sections of a scene file](scene.md) and [the command line](command_line.md).\n\n"
            f"## Nodes\n\n{table(('type', 'what it is'), nodes)}\n"
            f"## Modules\n\nSteps of a node's algorithm.\n\n{table(('type', 'what it does'), modules)}")


def without_shorthand(schema):
    """A schema as it is without what scene files may have beyond plain JSON: docs/scene_format.md tells that."""
    if isinstance(schema, list):
        return [without_shorthand(s) for s in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: without_shorthand(value) for key, value in schema.items()}
    if isinstance(plain.get("type"), list):
        plain["type"] = plain["type"][0]
        plain.pop("pattern", None)
    items = plain.get("items", {}) if plain.get("type") == "array" else {}
    if {"$ref": "#/$defs/repeat"} in items.get("anyOf", []):
        plain["items"] = items["anyOf"][0]
        plain.update(plain.pop("anyOf", [{}])[0])
    if isinstance(plain.get("properties"), dict):
        plain["properties"] = {n: s for n, s in plain["properties"].items() if n not in ("note", "$include")}
    return plain


def kind_of(schema):
    """The kind of value that a piece of JSON Schema allows, and whether it may be keyframes."""
    options = schema.get("anyOf", [schema])
    animated = any("keyframes" in o.get("properties", {}) for o in options)
    plain = [o for o in options if o.get("type") != "null" and "keyframes" not in o.get("properties", {})]
    first = plain[0] if plain else schema
    if first.get("type") == "array":
        items = first.get("items", {}).get("type", "value")
        size = first.get("minItems")
        return (f"{size} {items}s" if size and size == first.get("maxItems") else f"list of {items}s"), animated, first
    kind = "choice" if "enum" in first or "oneOf" in first else first.get("type", "value")
    return kind, animated, first


def choices_of(schema):
    if "enum" in schema:
        return [(str(v), "") for v in schema["enum"]]
    return [(str(o["const"]), o.get("description", "")) for o in schema.get("oneOf", []) if "const" in o]


def schema_rows(properties, prefix=""):
    rows = []
    for name, schema in properties.items():
        kind, animated, plain = kind_of(schema)
        facts = [limits(plain.get("minimum"), plain.get("exclusiveMinimum"), plain.get("maximum"))]
        facts += ["may be keyframes"] if animated else []
        doc = escaped(schema.get("description", plain.get("description", "")))
        doc += "".join(f"<br>`{value}`" + (f": {escaped(text)}" if text else "") for value, text in choices_of(plain))
        default = code(schema["default"]) if schema.get("default") is not None else ""
        rows.append((f"`{prefix}{name}`", kind, default, "; ".join(f for f in facts if f), doc))
        inner = plain.get("properties") or plain.get("items", {}).get("properties", {})
        rows += schema_rows(inner, f"{prefix}{name}{'[]' if plain.get('type') == 'array' else ''}.")
    return rows


def scene_page(schema):
    heads = ("name", "kind", "default", "allowed", "what it is")
    text = "# Scene files\n\nA scene is one JSON file. [The tutorial](../tutorial_scene.md) builds one; `weir schema` prints " \
           "the JSON Schema, for completion and checking in an editor.\n\n"
    text += "[Scene files](../scene_format.md) tells of comments, variables, units, included files and repetition.\n\n"
    schema = without_shorthand(schema)
    sections = {n: s for n, s in schema["properties"].items() if s.get("type") == "object" and s.get("properties")}
    others = {n: s for n, s in schema["properties"].items() if n not in sections}
    text += "## The file\n\n" + table(heads, schema_rows(others)) + "\n"
    for name, section in sections.items():
        text += f"## {name}\n\n" + table(heads, schema_rows(section["properties"])) + "\n"
    return text


def command_page(program):
    text = "# The command line\n\nExit codes: 0 done, 1 --check found a file that would change, 2 wrong usage, " \
           "3 invalid scene, 4 the simulation failed, 5 a file could not be read or written, " \
           f"130 interrupted.\n\n```text\n{program.text('--help')}```\n"
    for command in program.commands():
        text += f"\n## weir {command}\n\n```text\n{program.text(command, '--help')}```\n"
    return text


def pages(program):
    """Every page of the reference: its path below docs/, and its Markdown."""
    types = program.types()
    result = {"reference/index.md": index_page(types), "reference/scene.md": scene_page(program.schema()),
              "reference/command_line.md": command_page(program)}
    for name, node in types["nodes"].items():
        result[f"reference/nodes/{name}.md"] = node_page(name, node, types["modules"])
    for name, module in types["modules"].items():
        result[f"reference/modules/{name}.md"] = module_page(name, module)
    return result
