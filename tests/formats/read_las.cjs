// Reads a LAS file with copc. Prints a line of JSON: {header, wkt, points: {dimension: [value, ...]}}.
//   node read_las.cjs FILE
const { readFileSync } = require("node:fs");

const { Las } = require("copc");

const bytes = readFileSync(process.argv[2]);
const get = async (begin, end) => bytes.subarray(begin, end);

(async () => {
  const header = Las.Header.parse(bytes);
  const frame = Las.Vlr.find(await Las.Vlr.walk(get, header), "LASF_Projection", 2112);
  const wkt = (await Las.Vlr.fetch(get, frame)).toString().replace(/\0$/, "");
  const view = Las.View.create(bytes.subarray(header.pointDataOffset), header);
  const points = {};
  for (const name of ["X", "Y", "Z", "Intensity", "ReturnNumber", "NumberOfReturns", "Classification", "UserData", "PointSourceId", "GpsTime"]) {
    const getter = view.getter(name);
    points[name] = Array.from({ length: view.pointCount }, (_, i) => getter(i));
  }
  console.log(JSON.stringify({ header, wkt, points }));
})();
