// Makes TypeScript types and decoders of the wire types, src/messages/generated.ts. LCM_TYPES names the folder of the .lcm files.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const folder = process.env.LCM_TYPES ?? "../../../lcmtypes";
const output = "src/messages/generated.ts";

// Of a primitive type: what reads one, what reads an array, its type and that of its array.
const primitives = {
  byte: { one: "byte", array: "Uint8Array" },
  boolean: { one: "boolean", array: "boolean[]" },
  int8_t: { one: "int8", array: "Int8Array" },
  int16_t: { one: "int16", array: "Int16Array" },
  int32_t: { one: "int32", array: "Int32Array" },
  int64_t: { one: "int64", array: "Float64Array" },
  float: { one: "float", array: "Float32Array" },
  double: { one: "double", array: "Float64Array" },
  string: { one: "string", array: "string[]" },
};
const typeOfOne = (type) => (type === "string" ? "string" : type === "boolean" ? "boolean" : type in primitives ? "number" : nameOf(type));
const nameOf = (type) => type.replace(/_t$/, "").replace(/(^|_)(\w)/g, (_, __, letter) => letter.toUpperCase());

function parse(text, file) {
  const code = text.replace(/\/\*[\s\S]*?\*\//g, "").replace(/\/\/.*$/gm, "");
  const struct = /struct\s+(\w+)\s*\{([\s\S]*)\}/.exec(code);
  if (!struct) throw new Error(`${file}: no struct`);
  const members = [], constants = [];
  for (const statement of struct[2].split(";").map((part) => part.trim().replace(/\s+/g, " ")).filter(Boolean)) {
    const constant = /^const (\w+) (.*)$/.exec(statement);
    if (constant) {
      for (const part of constant[2].split(",")) {
        const [name, value] = part.split("=").map((side) => side.trim());
        constants.push([name, Number(value)]);
      }
      continue;
    }
    const member = /^([\w.]+) (\w+)((?:\[\w+\])*)$/.exec(statement);
    if (!member) throw new Error(`${file}: not understood: ${statement}`);
    members.push({ type: member[1].replace(/^lookout\./, ""), name: member[2], sizes: [...member[3].matchAll(/\[(\w+)\]/g)].map((size) => size[1]) });
  }
  return { type: struct[1], members, constants };
}

const structs = new Map();
for (const file of readdirSync(folder).filter((name) => name.endsWith(".lcm")).sort()) {
  const struct = parse(readFileSync(join(folder, file), "utf8"), file);
  structs.set(struct.type, struct);
}

// LCM's fingerprints: lcmgen.c (hash of a struct), and what generated code does with those of its members.
const mask = (1n << 64n) - 1n;
function update(hash, character) {
  const arithmetic = BigInt.asIntN(64, hash) >> 55n;
  return (((hash << 8n) ^ arithmetic) + BigInt(character)) & mask;
}
function updateText(hash, text) {
  let result = update(hash, text.length);
  for (const character of text) result = update(result, character.charCodeAt(0));
  return result;
}
function ownHash({ members }) {
  let hash = 0x12345678n;
  for (const { type, name, sizes } of members) {
    hash = updateText(hash, name);
    if (type in primitives) hash = updateText(hash, type);
    hash = update(hash, sizes.length);
    for (const size of sizes) {
      const isConstant = /^\d+$/.test(size);
      hash = update(hash, isConstant ? 0 : 1);
      hash = updateText(hash, size);
    }
  }
  return hash;
}
function fingerprint(type, parents = []) {
  if (parents.includes(type)) return 0n;
  let hash = ownHash(structs.get(type));
  for (const member of structs.get(type).members) {
    if (!(member.type in primitives)) hash = (hash + fingerprint(member.type, [...parents, type])) & mask;
  }
  return ((hash << 1n) & mask) | (hash >> 63n);
}

function expression({ type, sizes }) {
  const one = type in primitives ? `reader.${primitives[type].one}()` : `decode${nameOf(type)}(reader)`;
  if (sizes.length === 0) return one;
  const count = (size) => (/^\d+$/.test(size) ? size : size);
  const last = count(sizes.at(-1));
  let array = type in primitives ? `reader.${primitives[type].one}s(${last})` : `reader.array(${last}, () => ${one})`;
  for (const size of sizes.slice(0, -1).reverse()) array = `reader.array(${count(size)}, () => ${array})`;
  return array;
}
function typeOf({ type, sizes }) {
  if (sizes.length === 0) return typeOfOne(type);
  const inner = type in primitives ? primitives[type].array : `${nameOf(type)}[]`;
  return inner + "[]".repeat(sizes.length - 1);
}

const lines = ["// Generated from lcmtypes/*.lcm by generate_messages.mjs: not to be edited.", 'import { Reader } from "./reader.js";', ""];
for (const { type, members, constants } of structs.values()) {
  const name = nameOf(type);
  lines.push(`export interface ${name} {`);
  for (const member of members) lines.push(`  ${member.name}: ${typeOf(member)};`);
  lines.push("}");
  lines.push(`export const ${name} = {`);
  lines.push(`  type: "${type}",`);
  lines.push(`  fingerprint: "${fingerprint(type).toString(16).padStart(16, "0")}",`);
  for (const [constant, value] of constants) lines.push(`  ${constant}: ${value},`);
  lines.push(`  /** @throws Refused when the bytes are of another type, cut short, or go on behind the message */`);
  lines.push(`  decode: (bytes: Uint8Array): ${name} => Reader.whole(bytes, ${name}.fingerprint, decode${name}),`);
  lines.push("} as const;");
  lines.push(`function decode${name}(reader: Reader): ${name} {`);
  for (const member of members) lines.push(`  const ${member.name} = ${expression(member)};`);
  lines.push(`  return { ${members.map((member) => member.name).join(", ")} };`);
  lines.push("}", "");
}
writeFileSync(output, lines.join("\n"));
