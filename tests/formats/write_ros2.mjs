// Writes messages as ROS 2 has them: by lines of JSON from standard input {topic, type, time, message} and the texts of their types, an MCAP file for
// each compression, and a line {topic, type, time, cdr} for each message on standard output (cdr in base64).
//   node write_ros2.mjs TYPES.json FOLDER
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createInterface } from "node:readline";

import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";

const [types_file, folder] = process.argv.slice(2);
const texts = JSON.parse(readFileSync(types_file, "utf8"));

class Memory {
  parts = [];
  length = 0;
  async write(bytes) {
    this.parts.push(Buffer.from(bytes));
    this.length += bytes.length;
  }
  position() {
    return BigInt(this.length);
  }
}

const run = (program, bytes) => execFileSync(program, ["-c", "-q"], { input: bytes, maxBuffer: 1 << 28 });
const compressions = { none: undefined, lz4: (bytes) => run("lz4", bytes), zstd: (bytes) => run("zstd", bytes) };

const files = {};
for (const [name, pack] of Object.entries(compressions)) {
  const memory = new Memory();
  const writer = new McapWriter({
    writable: memory,
    chunkSize: 1 << 20,
    compressChunk: pack && ((bytes) => ({ compression: name, compressedData: pack(bytes) })),
  });
  await writer.start({ profile: "ros2", library: "" });
  files[name] = { memory, writer, channels: new Map() };
}

const writers = new Map();
let sequence = 0;
for await (const line of createInterface({ input: process.stdin })) {
  const { topic, type, time, message } = JSON.parse(line);
  if (!writers.has(type)) writers.set(type, new serialization.MessageWriter(rosmsg.parse(texts[type], { ros2: true })));
  const data = writers.get(type).writeMessage(message);
  for (const { writer, channels } of Object.values(files)) {
    if (!channels.has(topic)) {
      const name = type.replace("/", "/msg/");
      const schemaId = await writer.registerSchema({ name, encoding: "ros2msg", data: new TextEncoder().encode(texts[type]) });
      channels.set(topic, await writer.registerChannel({ topic, schemaId, messageEncoding: "cdr", metadata: new Map() }));
    }
    const log_time = BigInt(time);
    await writer.addMessage({ channelId: channels.get(topic), sequence, logTime: log_time, publishTime: log_time, data });
  }
  ++sequence;
  process.stdout.write(JSON.stringify({ topic, type, time, cdr: Buffer.from(data).toString("base64") }) + "\n");
}
for (const [name, { memory, writer }] of Object.entries(files)) {
  await writer.end();
  writeFileSync(`${folder}/${name}.mcap`, Buffer.concat(memory.parts));
}
