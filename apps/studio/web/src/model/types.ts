// What the server tells of node and module types, as `weir nodes --json` prints it.

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonObject = { [key: string]: Json };

export interface Parameter {
  name: string;
  kind: string;
  /** Of lists: the kind of their elements, where there is an editor for it. */
  elements?: string;
  doc: string;
  /** Other words for it, by which people look for it. */
  also?: string[];
  default: Json;
  unit?: string;
  min?: number;
  above?: number;
  max?: number;
  soft_min?: number;
  soft_max?: number;
  /** The choices of another parameter of the same owner with which it means anything; always where there are none. */
  only_for?: { parameter: string; choices: string[] };
  live: boolean;
  animated: boolean;
  choices?: { [name: string]: string };
  parameters?: Parameter[];
}

export interface InputType {
  name: string;
  type: string;
  doc: string;
  required: boolean;
  many: boolean;
}

export interface OutputType {
  name: string;
  type: string;
  doc: string;
}

export interface ModuleSlot {
  name: string;
  type: string;
  enabled: boolean;
}

export interface NodeType {
  doc: string;
  also?: string[];
  source: string;
  inputs: InputType[];
  outputs: OutputType[];
  parameters: Parameter[];
  family?: string;
  modules?: ModuleSlot[];
}

export interface ModuleType {
  doc: string;
  also?: string[];
  source: string;
  family: string;
  parameters: Parameter[];
}

export interface Types {
  nodes: { [name: string]: NodeType };
  modules: { [name: string]: ModuleType };
  world: Parameter[];
  sections: { [name: string]: Parameter[] };
}

/** An error as the server tells it; see PROTOCOL.md. */
export interface Problem {
  message: string;
  allowed?: string;
  hint?: string;
  file?: string;
  line?: number;
  column?: number;
  pointer?: string;
  node?: string;
  parameter?: string;
  /** A file would be replaced. */
  exists?: boolean;
}
