#include "tools/replay/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "tools/replay/stage.hpp"

namespace lookout::replay {

namespace {

bool Holds(const std::vector<std::string>& names, std::string_view name) { return std::ranges::find(names, name) != names.end(); }

bool IsOfSecondLidar(const bus::Channel* channel) { return channel != nullptr && bus::IsOfSecondLidar(*channel); }

bool IsFromSeveral(const bus::Channel* channel) { return channel != nullptr && bus::HasSeveralPublishers(*channel); }

// Channels that are read wherever they are, and that nothing needs.
bool IsOptional(const bus::Channel* channel) { return IsFromSeveral(channel) || IsOfSecondLidar(channel); }

// Without what several may send, or a second lidar, and nobody must.
std::vector<const bus::Channel*> Inputs(const bus::ServiceRow& service) {
  std::vector<const bus::Channel*> inputs(service.inputs.begin(), service.inputs.end());
  std::erase_if(inputs, [](const auto* channel) { return channel == nullptr || IsOptional(channel); });
  return inputs;
}

std::vector<std::string_view> PublishersOf(const bus::Channel& channel, const ServiceRows& services) {
  std::vector<std::string_view> names;
  for (const auto& service : services) {
    if (bus::Publishes(service, channel)) names.push_back(service.name);
  }
  return names;
}

// Each once, in the order of the channel table; other channels stand last.
std::vector<std::string> InTableOrder(std::vector<const bus::Channel*> channels) {
  const auto place = [](const bus::Channel* channel) { return std::ranges::find(bus::kChannels, channel->name, &bus::Channel::name); };
  std::ranges::stable_sort(channels, {}, place);
  std::vector<std::string> names;
  for (const auto* channel : channels) {
    if (!Holds(names, channel->name)) names.emplace_back(channel->name);
  }
  return names;
}

// Adds to `stopped` the service and all whose outputs it needs.
void AddUpstream(std::string_view name, const ServiceRows& services, std::vector<std::string>& stopped) {
  const auto row = std::ranges::find(services, name, &bus::ServiceRow::name);
  if (row == services.end() || Holds(stopped, name)) return;
  stopped.emplace_back(name);
  if (bus::RawOutput(*row) != nullptr) return;
  for (const auto* input : Inputs(*row)) {
    for (const auto publisher : PublishersOf(*input, services)) AddUpstream(publisher, services, stopped);
  }
}

// Whether others read what the service publishes, and none of them runs.
bool IsOfNoUse(const bus::ServiceRow& service, const ServiceRows& services, const std::vector<std::string>& stopped) {
  bool has_reader = false;
  for (const auto& reader : services) {
    const auto inputs = Inputs(reader);
    if (std::ranges::none_of(inputs, [&service](const auto* input) { return bus::Publishes(service, *input); })) continue;
    if (!Holds(stopped, reader.name)) return false;
    has_reader = true;
  }
  return has_reader;
}

// Services that do not run with --from this channel.
std::vector<std::string> StoppedBy(const std::string& from, const ServiceRows& services) {
  std::vector<std::string> stopped;
  for (const auto& service : services) {
    for (const auto* input : Inputs(service)) {
      if (input->name != from || input->is_raw) continue;
      for (const auto publisher : PublishersOf(*input, services)) AddUpstream(publisher, services, stopped);
    }
  }
  // In the reverse order of the data: what one publishes only for a stopped one is of no use.
  for (auto service = services.rbegin(); service != services.rend(); ++service) {
    if (!Holds(stopped, service->name) && bus::RawOutput(*service) == nullptr && IsOfNoUse(*service, services, stopped))
      stopped.emplace_back(service->name);
  }
  return stopped;
}

// The running services, without their inputs yet.
Plan Running(const Request& request, const ServiceRows& services) {
  Plan plan{.services = ServiceNames(services), .table = services};
  for (const auto& name : request.only) {
    if (!Holds(plan.services, name)) throw RequestError(fmt::format("--only {}: is none of {}", name, fmt::join(plan.services, ", ")));
  }
  std::erase_if(plan.services, [&](const auto& name) { return !request.only.empty() && !Holds(request.only, name); });
  for (const auto& name : request.from) {
    if (!Holds(FromNames(services), name)) throw RequestError(fmt::format("--from {}: is none of {}", name, fmt::join(FromNames(services), ", ")));
    for (const auto& service : StoppedBy(name, services)) {
      if (Holds(request.only, service)) throw RequestError(fmt::format("--only {}: does not run with --from {}", service, name));
      std::erase(plan.services, service);
    }
  }
  return plan;
}

// Whether the service reads the raw channel that it publishes live, in place of its inputs.
bool ReadsRaw(const bus::ServiceRow& service, const Request& request, const ChannelSet& present) {
  const auto* const raw = bus::RawOutput(service);
  const auto inputs = Inputs(service);
  if (raw == nullptr) return false;
  if (inputs.empty() || Holds(request.from, raw->name)) return true;
  return present.contains(raw->name) && std::ranges::none_of(inputs, [&](const auto* input) { return Holds(request.from, input->name); });
}

// Adds the channels that services of the plan read and no service of the plan publishes.
void AddUnmet(const Request& request, const ChannelSet& present, const ServiceRows& services, Plan& plan) {
  std::vector<const bus::Channel*> unmet;
  for (const auto& service : services) {
    if (!plan.Runs(service.name)) continue;
    std::ranges::copy_if(service.inputs, std::back_inserter(unmet),
                         [&](const bus::Channel* input) { return IsFromSeveral(input) || (IsOfSecondLidar(input) && !plan.Publishes(*input)); });
    if (ReadsRaw(service, request, present)) {
      unmet.push_back(bus::RawOutput(service));
      for (const auto& channel : bus::kChannels) {
        if (channel.is_raw && bus::IsOfSecondLidar(channel) && bus::Publishes(service, channel)) unmet.push_back(&channel);
      }
      continue;
    }
    for (const auto* input : Inputs(service)) {
      if (!plan.Publishes(*input)) unmet.push_back(input);
    }
  }
  plan.read = InTableOrder(unmet);
  for (const auto& name : request.from) {
    if (!plan.Reads(name)) throw RequestError(fmt::format("--from {}: no service that runs reads it", name));
  }
}

// The services of the plan that have an input: datagrams (when nothing is read), the raw channel that they read, or one of their inputs.
std::vector<std::string> FedServices(const Plan& plan, const ChannelSet& present, const ServiceRows& services) {
  std::vector<std::string> fed;
  const auto is_met = [&](const bus::Channel* input) {
    const auto is_fed = [&](std::string_view publisher) { return Holds(fed, publisher); };
    return plan.Publishes(*input) ? std::ranges::any_of(PublishersOf(*input, services), is_fed) : present.contains(input->name);
  };
  for (const auto& service : services) {
    if (!plan.Runs(service.name)) continue;
    const auto* const raw = bus::RawOutput(service);
    bool is_fed = raw != nullptr && plan.read.empty();
    is_fed |= raw != nullptr && plan.Reads(raw->name) ? present.contains(raw->name) : std::ranges::any_of(Inputs(service), is_met);
    if (is_fed) fed.emplace_back(service.name);
  }
  return fed;
}

}  // namespace

bool Plan::Runs(std::string_view service) const { return Holds(services, service); }
bool Plan::Reads(std::string_view channel) const { return Holds(read, channel); }
bool Plan::Publishes(const bus::Channel& channel) const {
  return std::ranges::any_of(PublishersOf(channel, table), [this](std::string_view service) { return Runs(service); });
}
bool Plan::Gives(const bus::Channel& channel) const { return Publishes(channel) || (Reads(channel.name) && !Holds(absent, channel.name)); }

const ServiceRows& ReplayedServices() {
  static const ServiceRows kRows = [] {
    ServiceRows rows(bus::kServices.begin(), bus::kServices.end());
    std::erase_if(rows,
                  [](const auto& row) { return std::ranges::find(StageFactories(), row.name, &StageFactory::service) == StageFactories().end(); });
    return rows;
  }();
  return kRows;
}

std::vector<std::string> ServiceNames(const ServiceRows& services) {
  std::vector<std::string> names;
  for (const auto& service : services) names.emplace_back(service.name);
  return names;
}

std::vector<std::string> FromNames(const ServiceRows& services) {
  std::vector<const bus::Channel*> channels;
  for (const auto& service : services) {
    const auto inputs = Inputs(service);
    channels.insert(channels.end(), inputs.begin(), inputs.end());
    if (const auto* const raw = bus::RawOutput(service)) channels.push_back(raw);
  }
  return InTableOrder(channels);
}

ChannelSet Candidates(const Request& request, const ServiceRows& services) {
  Plan plan = Running(request, services);
  const auto all = FromNames(services);
  AddUnmet(request, {all.begin(), all.end()}, services, plan);
  ChannelSet candidates(plan.read.begin(), plan.read.end());
  std::erase_if(candidates, [](const auto& name) { return IsOptional(bus::FindChannel(name)); });
  return candidates;
}

Plan MakeLogPlan(const Request& request, const ChannelSet& present, const ServiceRows& services) {
  Plan plan = Running(request, services);
  AddUnmet(request, present, services, plan);
  for (const auto& name : request.from) {
    if (!present.contains(name)) throw std::runtime_error(fmt::format("--from {}: the input does not hold it", name));
  }
  const auto fed = FedServices(plan, present, services);
  for (const auto& service : request.only) {
    if (!Holds(fed, service)) throw std::runtime_error(fmt::format("--only {}: the input holds nothing that it reads", service));
  }
  if (fed.empty()) {
    throw std::runtime_error(
        fmt::format("the input holds none of {}: nothing can be computed again", fmt::join(Candidates(request, services), ", ")));
  }
  for (const auto& name : plan.read) {
    if (!present.contains(name) && !IsOptional(bus::FindChannel(name))) plan.absent.push_back(name);
  }
  return plan;
}

Plan MakeCapturePlan(const Request& request, const ServiceRows& services) {
  Plan plan = Running(request, services);
  if (!request.from.empty()) throw RequestError(fmt::format("--from {}: a capture holds datagrams, not messages", request.from.front()));
  const auto fed = FedServices(plan, {}, services);
  for (const auto& service : services) {
    if (!plan.Runs(service.name) || Holds(fed, service.name)) continue;
    std::vector<std::string_view> publishers;
    for (const auto* input : Inputs(service)) std::ranges::copy(PublishersOf(*input, services), std::back_inserter(publishers));
    throw RequestError(fmt::format("--only {}: a capture needs {} too", service.name, fmt::join(publishers, " or ")));
  }
  return plan;
}

bool IsWhole(const Plan& plan) { return plan.services.size() == ReplayedServices().size(); }

std::string InWords(const Plan& plan) {
  auto named = plan.read;
  std::erase_if(named, [](const auto& name) { return name == bus::kLidarBeams.name || IsOfSecondLidar(bus::FindChannel(name)); });
  return fmt::format("ran: {}\nread: {}\n", fmt::join(plan.services, ", "),
                     plan.read.empty() ? "datagrams" : fmt::format("{}", fmt::join(named, ", ")));
}

}  // namespace lookout::replay
