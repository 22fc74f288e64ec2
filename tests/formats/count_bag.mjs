// Counts the messages of a ROS bag by topic, as @foxglove/rosbag reads it: a line of JSON {topic: [count, first time in ns, last]}.
//   node count_bag.mjs FILE
import rosbag from "@foxglove/rosbag";
import node from "@foxglove/rosbag/node.js";
import { loadDecompressHandlers } from "@mcap/support";

const unpack = await loadDecompressHandlers();
const pack = (name) => (bytes, size) => unpack[name](bytes, BigInt(size));
const bag = new rosbag.Bag(new node.FileReader(process.argv[2]), { parse: false, decompress: { lz4: pack("lz4"), bz2: pack("bz2") } });
await bag.open();
const counts = {};
for await (const { topic, timestamp } of bag.messageIterator()) {
  const time = String(BigInt(timestamp.sec) * 1_000_000_000n + BigInt(timestamp.nsec));
  counts[topic] ??= [0, time, time];
  counts[topic][0] += 1;
  counts[topic][2] = time;
}
console.log(JSON.stringify(counts));
