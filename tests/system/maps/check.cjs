// Files of GeoJSON against RFC 7946: by check-geojson, and what that does not look at: the direction of rings (3.1.6), cuts at the 180th meridian
// (3.1.9), and times that belong to places.
const fs = require("fs");
const { getIssues } = require("@placemarkio/check-geojson");

const kPole = 90;
let numFaults = 0;
function fault(file, index, words) {
  if (++numFaults <= 10) console.log(`FAILED: ${file}: feature ${index}: ${words}`);
}

function checkLine(positions, tell) {
  for (const [longitude, latitude] of positions) {
    if (Math.abs(longitude) > 180 || Math.abs(latitude) > 90) tell(`a place at ${longitude}, ${latitude}`);
  }
  for (let i = 1; i < positions.length; ++i) {
    const atPole = Math.abs(positions[i][1]) === kPole && Math.abs(positions[i - 1][1]) === kPole;
    if (Math.abs(positions[i][0] - positions[i - 1][0]) > 180 && !atPole) tell("a line goes round the earth the long way");
  }
}

function checkRing(ring, tell) {
  checkLine(ring, tell);
  const [x0, y0] = ring[0];
  let area = 0;
  for (let i = 1; i < ring.length; ++i) {
    area += (ring[i - 1][0] - x0) * (ring[i][1] - y0) - (ring[i][0] - x0) * (ring[i - 1][1] - y0);
  }
  if (!(area > 0)) tell("an outer ring is not counter-clockwise");
}

function checkTimes(times, coordinates, tell) {
  if (times.length !== coordinates.length) tell(`${times.length} times of ${coordinates.length} places`);
  for (const time of times) if (Number.isNaN(Date.parse(time))) tell(`no time: ${time}`);
}

for (const file of process.argv.slice(2)) {
  const text = fs.readFileSync(file, "utf8");
  for (const issue of getIssues(text).slice(0, 3)) fault(file, "?", issue.message);
  JSON.parse(text).features.forEach(({ geometry, properties }, index) => {
    const tell = (words) => fault(file, index, words);
    const { type, coordinates } = geometry;
    if (type === "LineString") checkLine(coordinates, tell);
    if (type === "MultiLineString") coordinates.forEach((line) => checkLine(line, tell));
    if (type === "Polygon") coordinates.forEach((ring) => checkRing(ring, tell));
    if (type === "MultiPolygon") coordinates.forEach((polygon) => polygon.forEach((ring) => checkRing(ring, tell)));
    if (properties.coordTimes && type === "LineString") checkTimes(properties.coordTimes, coordinates, tell);
    if (properties.coordTimes && type === "MultiLineString") {
      coordinates.forEach((line, i) => checkTimes(properties.coordTimes[i], line, tell));
    }
  });
}
process.exit(numFaults === 0 ? 0 : 1);
