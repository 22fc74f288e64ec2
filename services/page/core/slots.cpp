#include "services/page/core/slots.hpp"

#include <algorithm>

namespace lookout::page {

void Slots::Put(ChannelIndex channel, std::string_view slot_name, std::int64_t group, int part, SharedBytes frame) {
  const Key key(channel, slot_name);
  auto found = slots_.find(key);
  if (found == slots_.end()) {
    if (slots_.size() >= kMaxSlots && !ForgetAnIdleOne()) {
      ++num_dropped_;
      return;
    }
    found = slots_.emplace(key, Slot{}).first;
  }
  auto& slot = found->second;
  const bool was_ready = slot.is_ready();
  const bool is_of_begun = slot.has_begun && slot.begun_group == group;
  if (!is_of_begun && slot.next_group != group) {
    num_replaced_ += static_cast<std::int64_t>(slot.next.size());
    Forget(slot.next);
    slot.next_group = group;
  }
  auto& parts = is_of_begun ? slot.begun : slot.next;
  if (const auto old = parts.find(part); old != parts.end()) {
    num_bytes_ -= old->second->size();
    parts.erase(old);
    ++num_replaced_;
  }
  if (num_bytes_ + frame->size() > kMaxBytes) {
    ++num_dropped_;
  } else {
    num_bytes_ += frame->size();
    parts.emplace(part, std::move(frame));
  }
  if (slot.is_ready() == was_ready) return;
  if (was_ready) {
    std::erase(ready_, key);
  } else {
    ready_.push_back(key);
  }
}

SharedBytes Slots::Take() {
  if (ready_.empty()) return nullptr;
  auto& slot = slots_.at(ready_.front());
  if (slot.begun.empty()) {
    slot.has_begun = true;
    slot.begun_group = slot.next_group;
    slot.begun = std::exchange(slot.next, {});
  }
  auto frame = std::move(slot.begun.begin()->second);
  slot.begun.erase(slot.begun.begin());
  num_bytes_ -= frame->size();
  if (slot.begun.empty()) {
    if (slot.is_ready()) ready_.push_back(ready_.front());
    ready_.pop_front();
  }
  return frame;
}

void Slots::KeepOnly(const std::vector<ChannelIndex>& channels) {
  const auto is_of_others = [&](const Key& key) { return std::ranges::find(channels, key.first) == channels.end(); };
  std::erase_if(ready_, is_of_others);
  for (auto slot = slots_.begin(); slot != slots_.end();) {
    if (!is_of_others(slot->first)) {
      ++slot;
      continue;
    }
    Forget(slot->second.begun);
    Forget(slot->second.next);
    slot = slots_.erase(slot);
  }
}

bool Slots::ForgetAnIdleOne() {
  const auto idle = std::ranges::find_if(slots_, [](const auto& item) { return !item.second.is_ready(); });
  if (idle == slots_.end()) return false;
  slots_.erase(idle);
  return true;
}

void Slots::Forget(Parts& parts) {
  for (const auto& [part, frame] : parts) num_bytes_ -= frame->size();
  parts.clear();
}

}  // namespace lookout::page
