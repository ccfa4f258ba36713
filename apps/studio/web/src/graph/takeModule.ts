// Takes a module to its node.
import { addNode, insertModule, pipelineOf, type Scene } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { hostOf } from "./addable";
import { showModules } from "./NodeModules";

/** Shows a module of its node; inserts it where it is not there, and a node for it where there is none. */
export function takeModule(module: string, at: { x: number; y: number }): void {
  const { scene, types, selected } = useStudio.getState();
  const family = types?.modules[module]?.family;
  const home = Object.entries(types?.nodes ?? {}).find(([, t]) => t.family === family);
  if (!types || !family || !home) return;
  const host = hostOf(scene, types, family, selected);
  const type = host === null ? home[1] : types.nodes[scene.nodes[host]!.type]!;
  let [next, name] = host === null ? addNode(scene, home[0], at) : [scene, host];
  const moduleOf = (s: Scene) => pipelineOf(s, name, type).find((m) => m.type === module)?.name;
  if (moduleOf(next) === undefined) next = insertModule(next, name, type, module);
  if (next !== scene) edit(() => next);
  showModules(name, true);
  useStudio.setState({ selected: [name], selectedLinks: [], wanted: { module: moduleOf(next) } });
}
