// Each line of the standard input, bytes of a datagram in hexadecimal digits, as node-mavlink understands it: a line of JSON for each message, with the
// number of its line, its fields, its bytes, and those that node-mavlink makes of the decoded values.
'use strict'
const { PassThrough } = require('stream')
const root = process.argv[2] + '/node_modules/'
const { MavLinkPacketSplitter, MavLinkPacketParser, MavLinkProtocolV2 } = require(root + 'node-mavlink')
const { minimal, common, ardupilotmega } = require(root + 'mavlink-mappings')
const registry = { ...minimal.REGISTRY, ...common.REGISTRY, ...ardupilotmega.REGISTRY }
const tell = (message) => console.log(JSON.stringify(message, (key, value) => (typeof value === 'bigint' ? Number(value) : value)))
const lines = require('fs').readFileSync(0, 'ascii').split('\n').slice(0, -1)

async function decode(line, number) {
  const source = new PassThrough()
  // The splitter passes on only frames with a right checksum.
  const reader = source.pipe(new MavLinkPacketSplitter()).pipe(new MavLinkPacketParser())
  source.end(Buffer.from(line, 'hex'))
  for await (const packet of reader) {
    const type = registry[packet.header.msgid]
    if (type === undefined) return tell({ line: number, error: 'message ' + packet.header.msgid })
    const data = packet.protocol.data(packet.payload, type)
    const again = new MavLinkProtocolV2(packet.header.sysid, packet.header.compid).serialize(data, packet.header.seq)
    tell({
      line: number, name: type.MSG_NAME, system: packet.header.sysid, component: packet.header.compid, sequence: packet.header.seq, fields: data,
      bytes: line, bytes_of_node_mavlink: again.toString('hex')
    })
  }
}

;(async () => {
  for (let number = 0; number < lines.length; ++number) await decode(lines[number], number)
})()
