// Seeds of AIS: messages of all types, in parts, as own ship, of places that cannot be.
#include <string>
#include <utility>
#include <vector>

#include "tests/fuzz/corpus.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace lookout::fuzz {

void WriteAis(const Folder& folder) {
  using namespace ais::test;
  const Position here{.latitude_deg = 54.3, .longitude_deg = 10.1, .speed_kn = 5.0, .course_deg = 90.0, .heading_deg = 92, .second = 1};
  const Position nowhere{.latitude_deg = 91.0, .longitude_deg = 181.0};
  const Position beyond{.latitude_deg = -110.0, .longitude_deg = 213.0};
  const std::vector<std::pair<std::string, Bits>> messages{{"class_a", ClassA(211000001, here)},
                                                           {"class_a_nowhere", ClassA(211000001, nowhere)},
                                                           {"class_a_beyond", ClassA(211000001, beyond)},
                                                           {"base", Base(2110001, here)},
                                                           {"static_a", StaticA(211000001, "EVEREST", "DH1", 70, {10, 20, 3, 4})},
                                                           {"aircraft", Aircraft(111211001, here, 300, 90)},
                                                           {"class_b", ClassB(211000002, here)},
                                                           {"extended_b", ExtendedB(211000002, here, "DINGHY", 37, {2, 3, 1, 1})},
                                                           {"aid", Aid(992111111, here, "FAIRWAY BUOY NUMBER 1234", false, {1, 1, 1, 1})},
                                                           {"static_b_name", StaticBName(211000002, "DINGHY")},
                                                           {"static_b_hull", StaticBHull(211000002, "DH2", 37, {0, 9, 0, 3})},
                                                           {"long_range", LongRange(211000003, here, 9, 270)}};
  // The target adds checksums, too.
  std::string all;
  for (const auto& [name, bits] : messages) {
    std::string text;
    for (const auto& line : Lines(bits)) text += line.substr(0, line.find('*')) + "\n";
    folder.Write(name, text);
    all += text;
  }
  folder.Write("all", all + "start\n" + all);
  folder.Write("own", Lines(ClassA(211000001, here), "AIVDO")[0] + "\n" + all);
  folder.Write("bad_parts", std::string("!AIVDM,9,9,9,A,1,0\n!AIVDM,2,1,1,B,177KQJ,0\n!AIVDM,3,2,1,B,177KQJ,5\n!AIVDM,0,0,,,,\n"));
}

}  // namespace lookout::fuzz
