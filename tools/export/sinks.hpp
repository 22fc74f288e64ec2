// Outputs of lookout-export: tables as CSV, a cloud as PLY, pictures as SVG. Maps: map_sinks.hpp.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "services/segmenter/params.hpp"
#include "tools/export/cloud.hpp"
#include "tools/export/scans.hpp"
#include "tools/export/selection.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Names of all tables, in the order of --help.
std::vector<std::string_view> TableNames();

/// @return the header line of a table without its end; empty when there is no such table
std::string_view TableHeader(std::string_view table);

/// @param near  of obstacles, tracks and pose: rows outside are left out, also those without a place; Finish throws std::runtime_error when none is
/// left
/// @return the writer of `table` as CSV, without header; nullptr when there is no such table, or it is merges
std::unique_ptr<Sink> MakeCsvSink(std::string_view table, const std::optional<Circle>& near);

/// The labelled cloud of one scan (binary, little-endian), for MeshLab, CloudCompare or Open3D.
///
/// @param seq  of the scan; nullopt = the last whole one
std::unique_ptr<Sink> MakePlySink(std::optional<std::int64_t> seq);

/// A cloud of one scan, or of all that it is given.
///
/// @param seq  of one scan; nullopt = the last whole one
/// Finish throws std::runtime_error where no return has a place in the frame; Take where the mounting is not known.
std::unique_ptr<Sink> MakeCloudSink(std::unique_ptr<CloudWriter> writer, CloudFrame frame, std::optional<std::int64_t> seq, bool is_of_one_scan);

/// One scan from above, 1320 x 1000 pixels: its returns with their segments, or its obstacles. Equal logs give equal text.
std::unique_ptr<Sink> MakeScanSvgSink(ChosenScan::Of what, std::optional<std::int64_t> seq);

/// The pairs of pieces that were judged in each round of merging when a scan is segmented again, with the part of each feature.
///
/// @param params     of method LOOKOUT
/// @param seq        of the scan; nullopt = the last whole one
/// @param all_scans  in place of one
/// Finish throws std::runtime_error where there is no scan of that number.
std::unique_ptr<Sink> MakeMergesSink(const segmenter::Params& params, std::optional<std::int64_t> seq, bool all_scans);
std::string_view MergesHeader();

/// One scan from above as MakeScanSvgSink draws it, but segmented again, with the pairs of the last round of merging.
///
/// @param params  of method LOOKOUT
std::unique_ptr<Sink> MakeMergesSvgSink(const segmenter::Params& params, const config::BoatFacts& boat, std::optional<std::int64_t> seq);

/// The track of the boat out of POSE, 1320 x 1000 pixels: north up, one line for each stretch of one status. Places closer than 0.2 m to the last one
/// are left out, so that a day at anchor stays small. Poses without position break the line.
///
/// @param has_tracks  also the tracker's results: the confirmed tracks, with the way of moving ones; remembered land; where the boat was when each
/// alert came up
std::unique_ptr<Sink> MakeTrackSvgSink(bool has_tracks);

}  // namespace lookout::exporter
