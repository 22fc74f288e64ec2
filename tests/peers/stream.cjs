// What a client of signalk-server is told: each text, with the time at which it came. Asks for all targets and all of the own ship.
//   node stream.cjs NPM_FOLDER URL TOKEN
'use strict'
const WebSocket = require(process.argv[2] + '/node_modules/ws')
const socket = new WebSocket(process.argv[3], { headers: process.argv[4] ? { Authorization: 'Bearer ' + process.argv[4] } : {} })
socket.on('open', () => {
  for (const context of ['targets.*', 'vessels.self']) {
    socket.send(JSON.stringify({ context, subscribe: [{ path: '*', policy: 'instant' }] }))
  }
})
socket.on('message', (text) => console.log(JSON.stringify({ time_s: Date.now() / 1000, message: JSON.parse(text) })))
socket.on('error', (error) => {
  console.error(String(error))
  process.exit(1)
})
