// Each line of the standard input as canboatjs understands it: a line of JSON for each whole message, with the number of its (last) line.
// Of a message in one line (Actisense) its bytes, too, and those that canboatjs makes of the decoded values.
'use strict'
const { FromPgn, toPgn } = require(process.argv[2] + '/node_modules/@canboat/canboatjs')
const parser = new FromPgn({ returnNulls: true })
const tell = (message) => console.log(JSON.stringify(message))
let number = 0
parser.on('error', (pgn, error) => tell({ line: number, error: String(error.message || error) }))
parser.on('warning', (pgn, warning) => tell({ line: number, error: String(warning) }))
for (const line of require('fs').readFileSync(0, 'ascii').split('\n').slice(0, -1)) {
  const { pgn, src, prio, dst, time, fields } = parser.parseString(line) || {}
  if (pgn !== undefined) {
    const message = { line: number, pgn, src, prio, time, fields }
    if (line.startsWith('A')) {
      message.bytes = line.trim().split(' ')[3]
      message.bytes_of_canboat = toPgn({ pgn, src, prio, dst, fields }).toString('hex').toUpperCase()
    }
    tell(message)
  }
  number += 1
}
