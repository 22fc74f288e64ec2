// lookout-archive: many recordings, replayed under versions of config and programs, and compared.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/version.hpp"
#include "tools/archive/compare.hpp"
#include "tools/archive/plan.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/query.hpp"
#include "tools/archive/run.hpp"
#include "tools/archive/scan.hpp"
#include "tools/archive/work.hpp"

namespace {

namespace archive = lookout::archive;
namespace fs = std::filesystem;

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

std::vector<std::string> TableNames() {
  std::vector<std::string> names;
  for (const auto& table : archive::UnitTables()) names.emplace_back(table.name);
  return names;
}

// The work of a command, to be called once the command line is parsed. @return exit code
using Command = std::function<int(const archive::ArchiveFolder&)>;

struct Requests {
  fs::path folder = "archive";
  archive::ScanRequest scan;
  archive::PlanRequest plan;
  archive::RunRequest run;
  bool prints_engine = false;
  fs::path batch;
  archive::CompareRequest compare;
  std::string sql;
};

void AddScan(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto* scan = app.add_subcommand("scan", "folders of recordings into the index");
  scan->add_option("FOLDER", requests.scan.folders, "folder with lcm-logs, captures, text logs and bags, also below it")
      ->required()
      ->check(CLI::ExistingDirectory);
  commands[scan] = [&requests](const archive::ArchiveFolder& folder) {
    requests.scan.progress = stderr;
    archive::Scan(folder, requests.scan, std::cout);
    return EXIT_SUCCESS;
  };
}

void AddPlan(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto& request = requests.plan;
  request.programs = archive::OwnProgramFolder();
  request.tables = {"obstacles", "tracks", "alerts", "pose"};
  auto* plan = app.add_subcommand("plan", "the units of one or more versions, and which of them have a result");
  plan->add_option("--config", request.configs, "folder of the boat's *.txtpb files; given several times, each is a version")
      ->required()
      ->allow_extra_args(false)
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  plan->add_option("--name", request.names, "of the version, one for each --config; without it the name of its folder")->allow_extra_args(false);
  plan->add_option("--programs", request.programs, "folder with the programs that do the work; without it this program's own")
      ->check(CLI::ExistingDirectory);
  plan->add_option("--tables", request.tables, "tables that each unit exports, joined by commas")->delimiter(',')->check(CLI::IsMember(TableNames()));
  plan->add_option("--scenes", request.scenes, "runs of these scenes alone, joined by commas")->delimiter(',');
  plan->add_option("--cut-minutes", request.cut_minutes,
                   "long runs are cut at start marks, where that is exact, into parts of so many minutes; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  plan->add_flag("--verify", request.verifies, "read every result again, also where nothing says that it was changed");
  commands[plan] = [&request](const archive::ArchiveFolder& folder) {
    archive::MakePlan(folder, request, std::cout);
    return EXIT_SUCCESS;
  };
}

void AddRun(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto& request = requests.run;
  request.own_program = archive::OwnProgramFolder() / "lookout-archive";
  auto* run = app.add_subcommand("run", "what has no result yet, by an engine");
  run->add_option("--name", request.versions, "this version alone (several); without it all")->allow_extra_args(false);
  run->add_option("--engine", request.engine, "local, parallel, slurm, snakemake, or a file with commands for bash")->capture_default_str();
  run->add_flag("--print-engine", requests.prints_engine, "print the commands of the engine, and end");
  run->add_option("--jobs", request.num_jobs, "batches at a time")->check(CLI::Range(1, 100'000))->capture_default_str();
  run->add_option("--limit", request.limit, "so many units at most; 0: all")->check(CLI::NonNegativeNumber)->capture_default_str();
  run->add_option("--only", request.only, "condition in SQL: \"run.scene = 'rain' AND run.start_us > 1787997610250000\"");
  run->add_option("--batch", request.batch_units, "units a batch; 0: as many as make 1000 batches")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  run->add_option("--retries", request.num_retries, "further rounds for units that were killed or whose computer failed")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  run->add_flag("--again-failed", request.again_failed, "failed units too, once");
  commands[run] = [&requests, &request](const archive::ArchiveFolder& folder) {
    if (requests.prints_engine) {
      std::cout << archive::EngineText(request.engine);
      return EXIT_SUCCESS;
    }
    request.progress = stderr;
    const auto summary = archive::RunUnits(folder, request, std::cout);
    return summary.num_failed + summary.num_not_done == 0 ? EXIT_SUCCESS : kExitFailed;
  };
}

void AddCompare(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto& request = requests.compare;
  auto* compare = app.add_subcommand("compare", "two versions over all runs that both are planned for");
  compare->add_option("A", request.a, "version")->required();
  compare->add_option("B", request.b, "version")->required();
  compare->add_option("--csv", request.csv, "write a row per unit as a CSV file");
  compare->add_option("--html", request.html, "write the comparison as one page");
  compare->add_option("--worst", request.num_worst, "units on the page with pictures")->check(CLI::Range(0, 1000))->capture_default_str();
  compare->add_option("--fail-if", request.fail_if, "condition on a figure, such as \"miou_drop > 0.5\": exit code 1 where it holds (several)")
      ->allow_extra_args(false);
  compare->add_flag("--force", request.force, "replace files that are there");
  commands[compare] = [&request](const archive::ArchiveFolder& folder) {
    return archive::Compare(folder, request, std::cout) ? EXIT_SUCCESS : kExitFailed;
  };
}

void AddQuery(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto* query = app.add_subcommand("query", "SQL over the index and the tables of the results");
  query->add_option("SQL", requests.sql, "one SELECT")->required();
  commands[query] = [&requests](const archive::ArchiveFolder& folder) {
    archive::Query(folder, requests.sql, std::cout);
    return EXIT_SUCCESS;
  };
}

void AddWork(CLI::App& app, Requests& requests, std::map<CLI::App*, Command>& commands) {
  auto* work = app.add_subcommand("work", "the units of a batch: what an engine starts");
  work->add_option("--batch", requests.batch, "list of units that run has made")->required()->check(CLI::ExistingFile);
  commands[work] = [&requests](const archive::ArchiveFolder& folder) {
    return archive::WorkOnBatch(folder, requests.batch, std::cout) ? EXIT_SUCCESS : kExitFailed;
  };
}

}  // namespace

int main(int argc, char** argv) {
  lookout::io::CatchStopSignals();
  CLI::App app("Replays many recordings under versions of config and programs, and compares the results.", "lookout-archive");
  app.set_version_flag("--version", "lookout-archive " + lookout::runtime::Version());
  app.require_subcommand(1);
  app.fallthrough();
  app.footer("Exit code: 0 fine; 1 failed, or units failed or are not done, or a --fail-if holds; 2 wrong command line or config.");
  Requests requests;
  app.add_option("--archive", requests.folder, "folder of index and results")->capture_default_str();
  std::map<CLI::App*, Command> commands;
  try {
    AddScan(app, requests, commands);
    AddPlan(app, requests, commands);
    AddRun(app, requests, commands);
    AddCompare(app, requests, commands);
    AddQuery(app, requests, commands);
    AddWork(app, requests, commands);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    return app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage;
  }
  try {
    const archive::ArchiveFolder folder(fs::absolute(requests.folder));
    const int code = commands.at(app.get_subcommands().front())(folder);
    std::cout.flush();
    if (!std::cout) throw std::runtime_error("standard output could not be written");
    return code;
  } catch (const std::invalid_argument& error) {
    std::cerr << "lookout-archive: " << lookout::PrintableLines(error.what()) << '\n';
    return kExitUsage;
  } catch (const lookout::config::ConfigError& error) {
    std::cerr << lookout::PrintableLines(error.what()) << '\n';
    return kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "lookout-archive: " << lookout::PrintableLines(error.what()) << '\n';
    return kExitFailed;
  }
}
