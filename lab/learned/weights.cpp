#include "lab/learned/weights.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/bus/schema.hpp"
#include "common/core/bytes.hpp"

namespace lookout::learned {
namespace {

using Json = nlohmann::json;

std::string ReadBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return bytes;
}

std::vector<float> ToFloats(const std::string& payload) {
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size());
  std::vector<float> values;
  values.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 2 <= bytes.size(); i += 2) {
    values.push_back(Eigen::half_impl::half_to_float(Eigen::half_impl::raw_uint16_to_half(ReadU16LittleEndian(bytes, i))));
  }
  return values;
}

bool AreFinite(const auto& values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

}  // namespace

Weights ParseWeights(const std::string& about, const std::string& payload) {
  Weights weights;
  std::string digest;
  try {
    const auto json = Json::parse(about);
    weights.mean = json.at("mean").get<std::array<float, kNumChannels>>();
    weights.deviation = json.at("deviation").get<std::array<float, kNumChannels>>();
    weights.trained_on = json.at("trained_on").get<std::set<std::string>>();
    digest = json.at("weights_sha256").get<std::string>();
  } catch (const Json::exception& error) {
    throw std::runtime_error(error.what());
  }
  weights.values = ToFloats(payload);
  if (!AreFinite(weights.values) || !AreFinite(weights.mean) || !AreFinite(weights.deviation)) {
    throw std::runtime_error("holds a number that is not finite");
  }
  if (std::ranges::any_of(weights.deviation, [](float deviation) { return deviation <= 0.0F; })) {
    throw std::runtime_error("deviation: must be greater than 0");
  }
  bus::Sha256 sha256;
  sha256.Add(payload.data(), payload.size());
  if (sha256.Finish() != digest) throw std::runtime_error("is not about the weights beside it: their digest is another");
  return weights;
}

Weights ReadWeights(const std::filesystem::path& json_file) {
  const auto about = ReadBytes(json_file);
  const auto payload = ReadBytes(std::filesystem::path(json_file).replace_extension(".f16"));
  try {
    return ParseWeights(about, payload);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(json_file.string() + ": " + error.what());
  }
}

}  // namespace lookout::learned
