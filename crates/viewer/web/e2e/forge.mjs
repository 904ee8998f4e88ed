// Logs that no run of ours would write: made of a real one, record by record.

import { clone, create, createFileRegistry, fromBinary, toBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";
import { McapIndexedReader, McapWriter } from "@mcap/core";
import { decompress } from "fzstd";

/** All that is in a log, taken apart. */
export const takeApart = async (bytes) => {
  const readable = { size: async () => BigInt(bytes.length), read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd: (packed, size) => decompress(packed, new Uint8Array(Number(size))) } });
  const log = { schemas: [...reader.schemasById.values()], channels: [...reader.channelsById.values()], messages: [], metadata: [], attachments: [] };
  for await (const { type, ...record } of reader.readMessages()) log.messages.push(record);
  for await (const { type, ...record } of reader.readMetadata()) log.metadata.push(record);
  for await (const { type, ...record } of reader.readAttachments()) log.attachments.push(record);
  return log;
};

/** A log put together; a chunk for each message that ends one. */
export const putTogether = async (log, { chunkSize = 1 << 20, crcs = true, compress, end = true } = {}) => {
  const parts = [];
  let length = 0n;
  const writable = {
    write: async (bytes) => {
      parts.push(bytes.slice());
      length += BigInt(bytes.byteLength);
    },
    position: () => length,
  };
  const writer = new McapWriter({ writable, chunkSize, useChunks: true, ...(compress ? { compressChunk: (data) => ({ compression: "zstd", compressedData: compress(data) }) } : {}) });
  await writer.start({ library: "forge", profile: "wisdom" });
  for (const one of log.metadata.filter(({ name }) => name !== "wisdom.end")) await writer.addMetadata(one);
  for (const one of log.attachments) await writer.addAttachment(one);
  const schemas = new Map();
  for (const { id, ...schema } of log.schemas) schemas.set(id, await writer.registerSchema(schema));
  const channels = new Map();
  for (const { id, schemaId, ...channel } of log.channels) channels.set(id, await writer.registerChannel({ ...channel, schemaId: schemas.get(schemaId) ?? 0 }));
  for (const message of log.messages) await writer.addMessage({ ...message, channelId: channels.get(message.channelId) });
  if (end) for (const one of log.metadata.filter(({ name }) => name === "wisdom.end")) await writer.addMetadata(one);
  await writer.end();
  return Buffer.concat(parts);
};

/** What decodes and encodes the messages of a channel. */
export const codecs = (log) => {
  const schemas = new Map(log.schemas.map((schema) => [schema.id, schema]));
  const known = new Map();
  return (channelId) => {
    if (known.has(channelId)) return known.get(channelId);
    const { schemaId } = log.channels.find(({ id }) => id === channelId);
    const { name, data } = schemas.get(schemaId);
    const descriptor = createFileRegistry(fromBinary(FileDescriptorSetSchema, data)).getMessage(name);
    const codec = { descriptor, decode: (bytes) => fromBinary(descriptor, bytes), encode: (message) => toBinary(descriptor, message), copy: (message) => clone(descriptor, message), make: (fields) => create(descriptor, fields) };
    known.set(channelId, codec);
    return codec;
  };
};

export const topicOf = (log, message) => log.channels.find(({ id }) => id === message.channelId).topic;

/** Every text of a message made another, wherever it stands. */
const retold = (descriptor, message, text) => {
  for (const field of descriptor.fields) {
    const value = message[field.localName];
    if (field.fieldKind === "scalar" && typeof value === "string") message[field.localName] = text(value);
    if (field.fieldKind === "list" && field.listKind === "scalar") message[field.localName] = value.map((one) => (typeof one === "string" ? text(one) : one));
    if (field.fieldKind === "message" && value) retold(field.message, value, text);
    if (field.fieldKind === "list" && field.listKind === "message") for (const one of value) retold(field.message, one, text);
  }
};

/** A log with every text in it put through a function: fields of messages, metadata, names of files and topics unknown. */
export const withTexts = (log, text) => {
  const codec = codecs(log);
  return {
    ...log,
    metadata: log.metadata.map((one) => ({ ...one, metadata: new Map([...one.metadata].map(([key, value]) => [key, /^(grid|log|decision)_/.test(key) ? value : text(value)])) })),
    attachments: log.attachments.map((one) => (one.name === "mission/mission.toml" ? one : { ...one, name: text(one.name).slice(0, 60_000) })),
    messages: log.messages.map((message) => {
      const { descriptor, decode, encode } = codec(message.channelId);
      const fields = decode(message.data);
      retold(descriptor, fields, text);
      return { ...message, data: encode(fields) };
    }),
  };
};

/** A run gone through again and again: decisions are numbered on, the clock goes on, and goals are new each time. */
export const repeated = (log, times, { without = [] } = {}) => {
  const codec = codecs(log);
  const kept = log.messages.filter((message) => !without.includes(topicOf(log, message)));
  const decided = kept.filter((message) => topicOf(log, message) === "/decision").map((message) => codec(message.channelId).decode(message.data));
  const decisions = decided.length;
  const lastS = Math.max(...kept.map(({ logTime }) => Number(logTime / 1_000_000_000n))) + 60;
  const goalsOfOne = Math.max(...decided.flatMap((one) => one.choice.verdicts.map(({ goal }) => goal.id))) + 1;
  const messages = [];
  for (let round = 0; round < times; round++) {
    const later = (value) => value + round * lastS;
    const renumber = (goal) => goal + round * goalsOfOne;
    for (const message of kept) {
      const topic = topicOf(log, message);
      const { decode, encode } = codec(message.channelId);
      let { data } = message;
      if (round > 0 && topic === "/decision") {
        const one = decode(data);
        one.number += round * decisions;
        one.state.spent.timeS = later(one.state.spent.timeS);
        for (const verdict of one.choice.verdicts) verdict.goal.id = renumber(verdict.goal.id);
        if (one.choice.act.goal !== undefined) one.choice.act.goal = renumber(one.choice.act.goal);
        for (const option of one.objective.family) for (const stop of option.sequence.stops) stop.goal = renumber(stop.goal);
        data = encode(one);
      }
      if (round > 0 && topic === "/in/outcome") {
        const one = decode(data);
        one.decision += round * decisions;
        one.spent.timeS = later(one.spent.timeS);
        data = encode(one);
      }
      const time = message.logTime + BigInt(round) * BigInt(lastS) * 1_000_000_000n;
      messages.push({ ...message, data, logTime: time, publishTime: time, sequence: topic.startsWith("/in/") ? message.sequence : message.sequence + round * decisions });
    }
  }
  return { ...log, messages };
};

/** A log whose decisions know this many goals each. */
export const crowded = (log, goals) => {
  const codec = codecs(log);
  return {
    ...log,
    messages: log.messages.map((message) => {
      if (topicOf(log, message) !== "/decision") return message;
      const { decode, encode } = codec(message.channelId);
      const one = decode(message.data);
      const { verdicts } = one.choice;
      const deferred = verdicts.find(({ turn }) => turn === undefined) ?? verdicts[0];
      const { descriptor } = codec(message.channelId);
      const verdict = descriptor.fields.find(({ name }) => name === "choice").message.fields.find(({ name }) => name === "verdicts").message;
      for (let i = verdicts.length; i < goals; i++) {
        const copy = clone(verdict, deferred);
        copy.goal.id = 10_000 + i;
        copy.goal.target.row = (i * 7) % 100;
        copy.goal.target.col = (i * 13) % 100;
        copy.turn = undefined;
        verdicts.push(copy);
      }
      return { ...message, data: encode(one) };
    }),
  };
};
