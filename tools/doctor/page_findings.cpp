// Who sees the page, and what it lacks on this computer.
#include <string>

#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kSubject = "page";

}  // namespace

Findings CheckPage(const Observations& seen) {
  Findings findings;
  if (!seen.config.page) return findings;
  const auto& params = *seen.config.page;
  if (seen.page.is_port_taken && seen.LastHealth("page") == nullptr) {
    findings.push_back(Fault(kSubject, fmt::format("TCP port {} is taken by another program, and lookout-page is not heard", params.port),
                             "ss -ltnp names it; another port in page.txtpb"));
  } else {
    findings.push_back(Ok(kSubject, page::AddressOnThisComputer(params.bind_address, params.port) + ", for " + page::WhoSees(params.bind_address) +
                                        (params.allows_acknowledgements ? "; acknowledging needs the token" : "; nobody acknowledges")));
  }
  if (!seen.page.token_fault.empty()) findings.push_back(Warning(kSubject, seen.page.token_fault, "until then nobody acknowledges by the page"));
  if (!seen.page.map_fault.empty()) findings.push_back(Warning(kSubject, seen.page.map_fault, "map_file in page.txtpb"));
  constexpr double kGigabyte = 1e9;
  if (params.look_back.count() > 0 && seen.page.free_bytes >= 0 && seen.page.free_bytes < params.spool_max_bytes) {
    findings.push_back(
        Warning(kSubject,
                fmt::format("{:.1f} GB free for the last minutes, up to {:.1f} GB are wanted", static_cast<double>(seen.page.free_bytes) / kGigabyte,
                            static_cast<double>(params.spool_max_bytes) / kGigabyte),
                "look_back_folder or look_back_max_bytes in page.txtpb"));
  }
  return findings;
}

}  // namespace lookout::doctor
