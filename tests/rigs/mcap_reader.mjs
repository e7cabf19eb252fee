// Counts the messages of a recording by topic with @mcap/core, once by the index and once record by
// record. Usage: node tests/rigs/mcap_reader.mjs RECORDING     (after npm ci into .rigs)
import { open, readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const require = createRequire(new URL("../../.rigs/npm/package.json", import.meta.url));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const fzstd = require("fzstd");

const decompressHandlers = {
  zstd: (buffer, size) => fzstd.decompress(buffer, new Uint8Array(Number(size))),
};
const path = process.argv[2];

const indexed = new Map();
const file = await open(path);
const reader = await McapIndexedReader.Initialize({
  decompressHandlers,
  readable: {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const buffer = new Uint8Array(Number(size));
      const { bytesRead } = await file.read(buffer, 0, Number(size), Number(offset));
      if (bytesRead !== Number(size)) throw new Error(`failed to read ${size} bytes at ${offset}`);
      return buffer;
    },
  },
});
let last = 0n;
for await (const message of reader.readMessages()) {
  if (message.logTime < last) throw new Error("messages are not in the order of time");
  last = message.logTime;
  const topic = reader.channelsById.get(message.channelId).topic;
  indexed.set(topic, (indexed.get(topic) ?? 0) + 1);
}
await file.close();

const streamed = new Map();
const topics = new Map();
const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
stream.append(await readFile(path));
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  if (record.type === "Channel") topics.set(record.id, record.topic);
  if (record.type !== "Message") continue;
  const topic = topics.get(record.channelId);
  streamed.set(topic, (streamed.get(topic) ?? 0) + 1);
}
if (!stream.done()) throw new Error("the stream reader found no end of the file");

for (const [topic, count] of indexed) {
  if (streamed.get(topic) !== count) {
    throw new Error(`${topic}: ${count} messages by the index, ${streamed.get(topic)} in the stream`);
  }
  console.log(`${topic}: ${count}`);
}
