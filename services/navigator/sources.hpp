// Opens what navigator.txtpb names. For main, and for lookout-doctor.
#pragma once

#include <memory>

#include "common/io/source.hpp"
#include "common/runtime/source_reader.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"

namespace lookout::navigator {

/// @param connection  no text log: those are played by TextLogPlayer
/// @throws std::runtime_error when a UDP port cannot be opened; a serial port and a server may come later
std::unique_ptr<io::Source> OpenSource(const Connection& connection);

/// Passes a piece of the source `name` to the service.
void Pass(const std::string& name, const io::Source::Piece& piece, Service& service);

/// Opens all sources for `service`, which must live longer.
///
/// @return nullptr for source LOG: the service reads the bus alone
/// @throws std::runtime_error when one cannot be opened
std::unique_ptr<runtime::SourceReader> OpenSources(const Params& params, Service& service);

}  // namespace lookout::navigator
