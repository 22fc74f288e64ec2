// Seeds: recordings of others.
#include "tests/fuzz/corpus.hpp"
#include "tests/unit/import/made_folders.hpp"
#include "tests/unit/import/made_recordings.hpp"

namespace lookout::fuzz {

namespace {

void WriteScanFolders(const std::filesystem::path& root) {
  namespace made = importer::test;
  const Folder seeds(root / "fuzz_scan_folder");
  const auto write = [&](const std::string& name, char kind, const std::string& bytes) {
    Payload seed{static_cast<std::uint8_t>(kind)};
    seed.insert(seed.end(), bytes.begin(), bytes.end());
    seeds.Write(name, seed);
  };
  auto points = made::MadeTurn(10.0, 30.0, 10U);
  points.resize(64);
  write("text", 0, made::PcdBytes(points, made::PcdKind::kText));
  write("binary", 0, made::PcdBytes(points, made::PcdKind::kBinary, 4));
  write("compressed", 1, made::PcdBytes(points, made::PcdKind::kCompressed));
  write("kitti", 2, made::KittiBytes(points) + made::LabelBytes(points));
  write("boxes", 3,
        R"({"labels":[{"id":0,"category":"ship","box3d":{"dimension":{"width":1,"length":4,"height":6},"location":{"x":8,"y":0,"z":0},)"
        R"("orientation":{"rotationYaw":0.5}}}]})");
  write("oxts", 4, made::OxtsText());
  write("times", 5, "2011-09-26 13:02:25.964389445\n1.0e-01\na.pcd 1621234567.5\n");
  write("labels", 6, "10 obstacle car\n50 land\n");
}

}  // namespace

void WriteRecordings(const std::filesystem::path& root) {
  namespace made = importer::test;
  using importer::Encoding;
  using importer::Packing;
  const auto ros1 = made::SomeMessages(Encoding::kRos1);
  const auto cdr = made::SomeMessages(Encoding::kCdr);
  const Folder bags(root / "fuzz_ros_bag");
  const Folder files(root / "fuzz_mcap");
  bags.Write("none", made::MakeBag(ros1, Packing::kNone));
  bags.Write("bz2", made::MakeBag(ros1, Packing::kBzip2));
  bags.Write("lz4", made::MakeBag(ros1, Packing::kLz4));
  files.Write("none", made::MakeMcap(cdr, Packing::kNone));
  files.Write("zstd", made::MakeMcap(cdr, Packing::kZstd));
  files.Write("lz4", made::MakeMcap(cdr, Packing::kLz4));
  Folder(root / "fuzz_rosbag2").Write("database", made::MakeDatabase(cdr));
  WriteScanFolders(root);
  const Folder messages(root / "fuzz_ros_message");
  for (const auto encoding : {Encoding::kRos1, Encoding::kCdr}) {
    const auto first = static_cast<std::uint8_t>(encoding == Encoding::kRos1 ? 0 : 12);
    const auto write = [&](std::uint8_t kind, const Payload& bytes) {
      messages.Write(std::to_string(first + kind), Payload{static_cast<std::uint8_t>(first + kind)} + bytes);
    };
    Payload points;
    for (std::uint8_t i = 0; i < 40; ++i)
      points = points + made::Writer().Number(5.0F).Number(0.1F * static_cast<float>(i)).Number(1.0F).Number(std::uint16_t{1}).bytes;
    write(0, made::MakeCloud(encoding, 1, 40, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}}, points));
    write(1, made::MakeVelodyneScan(encoding, 2));
    write(2, made::MakeImu(encoding));
    write(3, made::MakeFix(encoding, 45.0, 9.0));
    write(4, made::MakeSentence(encoding, "$GPHDT,90.0,T*0C"));
    write(6, made::MakeTwist(encoding, 1.0, 2.0));
    write(8, made::MakeHesaiPackets(encoding, 2, true));
    write(9, made::MakeHesaiPackets(encoding, 2, false));
    write(10, made::MakeOusterPacket(encoding, 7));
  }
}

}  // namespace lookout::fuzz
