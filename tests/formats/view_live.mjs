// Looks at lookout-page as Foxglove does, by Foxglove's own client: subscribes every channel, decodes each message by the schema that was told, and
// compares its bytes with those of an MCAP file of the same log. Prints a line of JSON: {protocol, topics: {topic: {live, known, inFile}}, refused: [...]}.
//   node view_live.mjs PORT FILE SUBPROTOCOL
import { readFileSync } from "node:fs";

import protocol from "@foxglove/ws-protocol";
import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";
import WebSocket from "ws";

const { FoxgloveClient } = protocol;
const [port, file, subprotocol] = process.argv.slice(2);
const bytes = readFileSync(file);
const readable = { size: async () => BigInt(bytes.length), read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)) };
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: await loadDecompressHandlers() });
const topics = {};
const inFile = new Map();
for await (const message of reader.readMessages()) {
  const { topic, messageEncoding } = reader.channelsById.get(message.channelId);
  if (messageEncoding !== "protobuf") continue;
  (topics[topic] ??= { live: 0, known: 0, inFile: 0 }).inFile++;
  inFile.set(topic, (inFile.get(topic) ?? new Set()).add(Buffer.from(message.data).toString("base64")));
}

const quiet_ms = 3000, longest_ms = 60_000;
const refused = [];
const decoders = new Map();
const socket = new WebSocket(`ws://127.0.0.1:${port}`, [subprotocol]);
const client = new FoxgloveClient({ ws: socket });
const fail = (error) => {
  console.error(error);
  process.exit(1);
};
client.on("error", fail);
client.on("status", ({ level, message }) => refused.push(`${level} ${message}`));
client.on("serverInfo", ({ capabilities }) => { if (capabilities.length > 0) fail(`the server can do more than show: ${capabilities}`); });
client.on("advertise", (channels) => {
  for (const channel of channels) {
    const type = protobufFromBinaryDescriptor(Buffer.from(channel.schema, "base64")).lookupType(channel.schemaName);
    decoders.set(client.subscribe(channel.id), { topic: channel.topic, type });
  }
  // What a server that only shows must refuse.
  const id = client.advertise({ topic: "/x", encoding: "json", schemaName: "" });
  client.sendMessage(id, new TextEncoder().encode("{}"));
  client.getParameters([]);
  client.setParameters([{ name: "/x", value: 1 }]);
  client.sendServiceCallRequest({ serviceId: 1, callId: 1, encoding: "json", data: new Uint8Array(2) });
});
let last = 0;
client.on("message", ({ subscriptionId, timestamp, data }) => {
  last = Date.now();
  const { topic, type } = decoders.get(subscriptionId);
  const raw = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
  type.decode(raw);
  const age_ms = Date.now() - Number(timestamp / 1_000_000n);
  if (age_ms < -1000 || age_ms > 10_000) fail(`${topic} was received ${age_ms} ms ago`);
  const row = (topics[topic] ??= { live: 0, known: 0, inFile: 0 });
  row.live++;
  if (inFile.get(topic)?.has(raw.toString("base64"))) row.known++;
});
console.error("looking");
const began = Date.now();
setInterval(() => {
  if ((last === 0 || Date.now() - last < quiet_ms) && Date.now() - began < longest_ms) return;
  console.log(JSON.stringify({ protocol: socket.protocol, topics, refused }));
  process.exit(0);
}, 200);
