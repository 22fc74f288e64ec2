// A gateway of RAW text, as those of Yacht Devices, and behind it a network with one device: canboatjs's own, which claims address 35 first. Notes a line of
// JSON for each whole message of either as canboatjs understands it, and for each line that the program sent.
//   node n2k_gateway.cjs NPM_FOLDER PORT     each line of the standard input is a message (JSON) that canboatjs's device sends
'use strict'
const net = require('net')
const { FromPgn, N2kDevice, pgnToYdgwFullRawFormat } = require(process.argv[2] + '/node_modules/@canboat/canboatjs')
const tell = (note) => console.log(JSON.stringify({ time_s: Date.now() / 1000, ...note }))
const clients = new Set()
const parsers = { ours: new FromPgn({ returnNulls: true }), theirs: new FromPgn({ returnNulls: true }) }
for (const parser of Object.values(parsers)) {
  parser.on('error', (pgn, error) => tell({ error: String(error.message || error) }))
  parser.on('warning', (pgn, warning) => tell({ error: String(warning) }))
}

// Heard by all: as the gateway tells of it.
const hear = (line, from) => {
  for (const client of clients) client.write(line + '\r\n')
  const { pgn, src, dst, prio, fields } = parsers[from].parseString(line.replace(' T ', ' R ')) || {}
  if (pgn === undefined) return
  tell({ from, pgn, src, dst, prio, fields })
  if (from === 'ours') device.n2kMessage({ pgn, src, dst, prio, fields })
}

class Device extends N2kDevice {
  sendPGN(message, source) {
    message.src = source || this.address
    for (const line of pgnToYdgwFullRawFormat(message)) hear(line.toUpperCase(), 'theirs')
  }
}
const device = new Device({ preferredAddress: 35, uniqueNumber: 1, addressClaimDetectionTime: 300 }, 'lookout:trial')
device.start()

const server = net.createServer((client) => {
  let rest = ''
  clients.add(client)
  client.on('close', () => clients.delete(client))
  client.on('error', () => clients.delete(client))
  client.on('data', (data) => {
    const lines = (rest + data.toString('ascii')).split('\r\n')
    rest = lines.pop()
    for (const line of lines) {
      tell({ sent: line })
      hear(new Date().toISOString().slice(11, 23) + ' T ' + line, 'ours')
    }
  })
})
setTimeout(() => server.listen(Number(process.argv[3]), '127.0.0.1'), 1500)
require('readline').createInterface({ input: process.stdin }).on('line', (line) => device.sendPGN(JSON.parse(line)))
