// Finds everything: what there is in the scene and its parameters, what can be added, templates, and what the page can do.
import { useEffect, useMemo, useState } from "react";
import { Finder, type Found } from "../Finder";
import { modulesToAdd, nodesToAdd } from "../graph/addable";
import { surface } from "../graph/surface";
import { takeModule } from "../graph/takeModule";
import { kModuleRole, kOther, roleOf, type Role } from "../model/roles";
import { labelOf } from "../model/parameters";
import { addNode, pipelineOf, type Scene } from "../model/scene";
import { newScene, openScene, redo, undo } from "../model/documents";
import { pinRun } from "../model/recorded";
import { askRun, edit, resetRun, say, useStudio, type Wanted } from "../model/store";
import type { Parameter, Types } from "../model/types";
import { fetchTemplates, type Template } from "../protocol/client";
import { startTour } from "../Tour";
import { Dialog } from "./Dialog";
import { save } from "./FileBar";

const kCommand: Role = { ...kOther, name: "Commands", icon: "go" };
const kGoTo = "In this scene";

const show = (selected: string[], wanted: Wanted | null) => useStudio.setState({ selected, selectedLinks: [], wanted });

/** The parameters of an owner, those inside groups too. */
function leaves(parameters: Parameter[], path: string[] = []): { parameter: Parameter; path: string[] }[] {
  return parameters.flatMap((p) => {
    const here = [...path, p.name];
    return p.parameters && p.kind !== "group list" ? leaves(p.parameters, here) : [{ parameter: p, path: here }];
  });
}

/** Nodes, modules and parameters of the scene. */
export function thingsOf(scene: Scene, types: Types): Found[] {
  const parameters = (owner: string, all: Parameter[], role: Role, selected: string[], module?: string): Found[] =>
    leaves(all).map(({ parameter, path }) => ({
      id: `${owner}/${path.join("/")}`, name: path.at(-1)!, beside: [owner, ...path.slice(0, -1)].join(" / "), doc: parameter.doc, role, group: "Parameters",
      synonyms: [labelOf(parameter.name).toLowerCase(), ...(parameter.also ?? [])], take: () => show(selected, { module, path: module === undefined && selected.length === 0 ? [owner, ...path] : path }),
    }));
  const nodes = Object.entries(scene.nodes).flatMap(([name, spec]): Found[] => {
    const type = types.nodes[spec.type], role = roleOf(type);
    const modules = (type ? pipelineOf(scene, name, type) : []).filter((m) => m.type in types.modules).flatMap((m): Found[] => [
      { id: `${name}/${m.name}`, name: m.name, beside: `module of ${name}`, doc: types.modules[m.type]!.doc, synonyms: types.modules[m.type]!.also ?? [], role: kModuleRole, group: kGoTo, take: () => show([name], { module: m.name }) },
      ...parameters(`${name} / ${m.name}`, types.modules[m.type]!.parameters, kModuleRole, [name], m.name),
    ]);
    return [
      { id: name, name, beside: spec.type, ...(type && { doc: type.doc }), synonyms: type?.also ?? [], role, group: kGoTo, take: () => show([name], null) },
      ...parameters(name, type?.parameters ?? [], role, [name]), ...modules,
    ];
  });
  const sections = Object.entries({ world: types.world, ...types.sections }).flatMap(([name, all]) => parameters(name, all, kOther, []));
  return [...nodes, ...sections].sort((a, b) => Number(a.group !== kGoTo) - Number(b.group !== kGoTo));
}

function commands(onDark: () => void): Found[] {
  const all: [name: string, beside: string, synonyms: string[], take: () => void][] = [
    ["Play", "Space", ["run", "start"], () => void askRun("play")], ["Pause", "Space", ["stop"], () => void askRun("pause")], ["One frame", ".", ["step"], () => void askRun("step")],
    ["Reset", "R", ["restart", "build", "time 0"], () => void resetRun(useStudio.getState().device)],
    ["Compare with the next run", "", ["pin", "keep", "A B", "side by side"], () => void pinRun()],
    ["Save", "Ctrl+S", ["write"], save], ["Save as", "", ["copy"], () => useStudio.setState({ dialog: "save" })],
    ["Open", "", ["load", "file"], () => useStudio.setState({ dialog: "open" })], ["Versions", "", ["history", "earlier", "backup", "restore"], () => useStudio.setState((s) => ({ dialog: s.sceneState.path ? "versions" : "save" }))], ["New", "", ["empty", "clear"], () => void newScene()],
    ["Templates", "", ["examples", "gallery"], () => useStudio.setState({ dialog: "templates" })], ["Undo", "Ctrl+Z", ["back"], () => void undo()], ["Redo", "Ctrl+Shift+Z", [], () => void redo()],
    ["Show the whole graph", "F", ["fit", "zoom"], surface.fit], ["Light or dark", "", ["theme", "colours"], onDark], ["Keys", "?", ["help", "shortcuts"], () => useStudio.setState({ dialog: "help" })],
    ["Water in a minute: the tour", "", ["help", "first", "learn", "tutorial"], startTour],
    ["Scene settings", "Escape", ["world", "title"], () => show([], null)],
  ];
  return all.map(([name, beside, synonyms, take]) => ({ id: `do ${name}`, name, beside, synonyms, role: kCommand, group: kCommand.name, take }));
}

const templates = (all: Template[]): Found[] =>
  all.map((t) => ({
    id: `template ${t.path}`, name: t.title || t.path, beside: "template", doc: t.description, role: { ...kOther, icon: "play" }, group: "Templates",
    take: () => void openScene({ template: t.path }),
  }));

export function Palette({ onClose, onDark }: { onClose(): void; onDark(): void }) {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const [offered, setOffered] = useState<Template[]>([]);
  useEffect(() => void fetchTemplates().then(setOffered, say), []);
  const items = useMemo((): Found[] => {
    if (!types) return [];
    const add = (type: string) => edit((s) => {
      const [next, name] = addNode(s, type, surface.middle());
      useStudio.setState({ selected: [name], selectedLinks: [] });
      return next;
    });
    const all = [
      ...commands(onDark), ...thingsOf(scene, types), ...nodesToAdd(types, () => true, add).map((i) => ({ ...i, beside: "add" })),
      ...modulesToAdd(types, (m) => takeModule(m, surface.middle())), ...templates(offered),
    ];
    // The box closes first: it gives the keyboard back to where it was.
    return all.map((i) => ({ ...i, take: () => (onClose(), setTimeout(i.take)) }));
  }, [scene, types, offered, onClose, onDark]);
  return (
    <Dialog title="Find anything" className="palette finder" onClose={onClose}>
      <Finder items={items} label="Find anything" placeholder="Nodes, modules, parameters, templates, commands" onClose={onClose} />
    </Dialog>
  );
}
