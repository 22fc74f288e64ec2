#include "tools/archive/sidecar.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/recipe_json.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostSidecarBytes = 1024UL * 1024;

// A name in a sidecar is one in its folder, whoever wrote the sidecar.
bool IsPlainName(const std::string& name) {
  return !name.empty() && name.front() != '.' && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789._") == std::string::npos;
}

std::string StampText(const std::string& name, const FileStamp& stamp) {
  return name + ' ' + std::to_string(stamp.size_bytes) + ' ' + std::to_string(stamp.modified_ns) + ' ' + std::to_string(stamp.changed_ns) + ' ' +
         std::to_string(stamp.inode) + '\n';
}

// A digest over the status of the sidecar and of each file, and the names; empty: something is not there.
std::string StampOfNames(const ArchiveFolder& archive, const std::string& key, const std::vector<std::string>& names) {
  const auto sidecar = StampOf(archive.Sidecar(key));
  if (!sidecar) return "";
  auto lines = StampText(".", *sidecar);
  const auto folder = archive.Result(key);
  std::string joined;
  for (const auto& name : names) {
    const auto stamp = StampOf(folder / name);
    if (!stamp) return "";
    lines += StampText(name, *stamp);
    joined += " " + name;
  }
  return DigestOfText(lines) + joined;
}

std::vector<std::string> NamesOf(const Sidecar& sidecar) {
  std::vector<std::string> names;
  names.reserve(sidecar.files.size());
  for (const auto& [name, file] : sidecar.files) names.push_back(name);
  return names;
}

std::string FaultOfFiles(const ArchiveFolder& archive, const std::string& key, const Sidecar& sidecar) {
  const auto folder = archive.Result(key);
  std::error_code error;
  std::size_t num_there = 0;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) ++num_there;
  if (num_there > sidecar.files.size()) return "a file more than the sidecar names";
  for (const auto& [name, file] : sidecar.files) {
    const auto stamp = StampOf(folder / name);
    if (!stamp) return name + " is missing";
    if (stamp->size_bytes != file.size_bytes) return name + " has another size than the sidecar says";
    if (DigestOfFile(folder / name) != file.digest) return name + " was changed: its digest is not the sidecar's";
  }
  return "";
}

}  // namespace

std::string SidecarText(const Sidecar& sidecar) {
  nlohmann::json files = nlohmann::json::object();
  for (const auto& [name, file] : sidecar.files) files[name] = {{"size_bytes", file.size_bytes}, {"sha256", file.digest}};
  nlohmann::json body{{"recipe", RecipeJson(sidecar.recipe)},
                      {"outcome", sidecar.is_done ? "done" : "failed"},
                      {"reason", sidecar.reason},
                      {"remarks", sidecar.remarks},
                      {"files", files}};
  const auto digest = DigestOfText(body.dump());
  body["sha256"] = digest;
  return body.dump(1) + "\n";
}

Sidecar SidecarOfText(const std::string& text) {
  try {
    auto body = nlohmann::json::parse(text);
    const auto digest = body.at("sha256").get<std::string>();
    body.erase("sha256");
    if (DigestOfText(body.dump()) != digest) throw std::runtime_error("its own digest does not hold");
    Sidecar sidecar;
    sidecar.recipe = RecipeOfJson(body.at("recipe"));
    const auto outcome = body.at("outcome").get<std::string>();
    if (outcome != "done" && outcome != "failed") throw std::runtime_error("an outcome that is none");
    sidecar.is_done = outcome == "done";
    sidecar.reason = body.at("reason").get<std::string>();
    sidecar.remarks = body.at("remarks").get<std::vector<std::string>>();
    for (const auto& [name, file] : body.at("files").items()) {
      if (!IsPlainName(name)) throw std::runtime_error("a file name that is none");
      sidecar.files[name] = {file.at("size_bytes").get<std::int64_t>(), file.at("sha256").get<std::string>()};
    }
    return sidecar;
  } catch (const std::exception& error) {
    throw std::runtime_error("the sidecar cannot be used: " + Printable(error.what()));
  }
}

Validity Verify(const ArchiveFolder& archive, const std::string& key) {
  Validity validity;
  const auto place = archive.Sidecar(key);
  const auto stamp = StampOf(place);
  if (!stamp) return validity;
  try {
    if (static_cast<std::uintmax_t>(stamp->size_bytes) > kMostSidecarBytes) throw std::runtime_error("the sidecar is too large to be one");
    std::ifstream in(place, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    const auto sidecar = SidecarOfText(text.str());
    if (KeyOf(sidecar.recipe) != key) throw std::runtime_error("the sidecar is of another unit");
    const auto stamps = StampOfNames(archive, key, NamesOf(sidecar));  // before the files are read: a change meanwhile shows at the next look
    if (const auto fault = FaultOfFiles(archive, key, sidecar); !fault.empty()) throw std::runtime_error(fault);
    validity = {true, sidecar.is_done, sidecar.reason, stamps};
  } catch (const io::Stopped&) {
    throw;
  } catch (const std::exception& error) {
    validity.reason = error.what();
  }
  return validity;
}

std::string StampOfResult(const ArchiveFolder& archive, const std::string& key, const std::string& verified_stamp) {
  std::vector<std::string> names;
  for (auto begin = verified_stamp.find(' '); begin != std::string::npos;) {  // behind the digest
    const auto end = verified_stamp.find(' ', begin + 1);
    names.push_back(verified_stamp.substr(begin + 1, end - begin - 1));
    begin = end;
  }
  return StampOfNames(archive, key, names);
}

void RemoveResult(const ArchiveFolder& archive, const std::string& key) {
  fs::remove(archive.Sidecar(key));
  fs::remove_all(archive.Result(key));
}

}  // namespace lookout::archive
