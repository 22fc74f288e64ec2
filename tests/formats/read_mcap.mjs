// Reads an MCAP file of lookout-export with the libraries of MCAP, by its index and as a stream, checks its checksums, decodes the messages in Protobuf
// by the descriptors in the file, and compares these with Foxglove's own. Prints a line of JSON: {counts, messages: {topic: [message, ...]}}.
//   node read_mcap.mjs FILE
import { readFileSync } from "node:fs";

import internal from "@foxglove/schemas/internal.js";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";
import protobufjs from "protobufjs";

const { foxgloveEnumSchemas, foxgloveMessageSchemas, generateProto } = internal;
const bytes = readFileSync(process.argv[2]);
const decompressHandlers = await loadDecompressHandlers();
const readable = { size: async () => BigInt(bytes.length), read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)) };
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const require = (holds, words) => {
  if (!holds) throw new Error(words);
};

// Fields of each message and values of each enumeration: names, numbers and types as theirs.
const theirs = new protobufjs.Root();
for (const schema of Object.values(foxgloveMessageSchemas)) {
  const enums = Object.values(foxgloveEnumSchemas).filter((one) => one.parentSchemaName === schema.name);
  protobufjs.parse(generateProto(schema, enums), theirs, { keepCase: true });
}
const compared = new Set();
const compare = (ours) => {
  if (compared.has(ours.fullName) || !ours.fullName.startsWith(".foxglove.")) return;
  compared.add(ours.fullName);
  const type = theirs.lookupTypeOrEnum(ours.fullName);
  if (ours instanceof protobufjs.Enum) {
    require(JSON.stringify(ours.values) === JSON.stringify(type.values), `${ours.fullName} is another enumeration`);
    return;
  }
  for (const field of ours.fieldsArray) {
    const known = type.fieldsById[field.id];
    const word = (type_name) => type_name.split(".").pop();
    const agrees = known && known.name === field.name && word(known.type) === word(field.type) && known.repeated === field.repeated;
    require(agrees, `${ours.fullName}.${field.name} is another field`);
    if (field.resolve().resolvedType) compare(field.resolvedType);
  }
};

const decoders = new Map();
const counts = {};
const messages = {};
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const { topic, messageEncoding, schemaId } = reader.channelsById.get(message.channelId);
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (messageEncoding !== "protobuf") continue;
  const schema = reader.schemasById.get(schemaId);
  if (!decoders.has(schema.name)) {
    const type = protobufFromBinaryDescriptor(schema.data).lookupType(schema.name);
    compare(type);
    decoders.set(schema.name, type);
  }
  const type = decoders.get(schema.name);
  const decoded = type.toObject(type.decode(message.data), { bytes: String, longs: Number, enums: String, defaults: true });
  (messages[topic] ??= []).push(decoded);
}
for await (const attachment of reader.readAttachments({ validateCrc: true })) counts[`attachment ${attachment.name}`] = attachment.data.length;

const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
let num_streamed = 0;
for (let record; (record = stream.nextRecord()); ) num_streamed += record.type === "Message" ? 1 : 0;
require(stream.done(), "the stream has no end");
const num_indexed = Number(reader.statistics.messageCount);
require(num_streamed === num_indexed, `${num_streamed} messages in the stream, ${num_indexed} by the index`);
console.log(JSON.stringify({ counts, messages, compared: [...compared] }));
