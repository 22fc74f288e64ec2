#include "services/plotter/signal_k_output.hpp"

#include <gtest/gtest.h>

#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter {
namespace {

class PlotterSignalKOutput : public test::ServiceFixture {};

TEST_F(PlotterSignalKOutput, ShowsTargetsAsVesselsWhereAsked) {
  std::vector<std::unique_ptr<Output>> outputs;
  auto link = std::make_unique<test::KeepingLink>();
  auto* const vessels = link.get();
  outputs.push_back(std::make_unique<SignalKOutput>(OutputParams{.name = "signalk", .format = Format::kSignalK, .targets_as_vessels = true},
                                                    std::move(link), params_.boat));
  NewBus();
  service_ = std::make_unique<Service>(*bus_, params_, std::move(outputs));
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  const auto context = VesselContext("gannet", 1);
  EXPECT_EQ(vessels->With(context).size(), vessels->With("targets.lidar:gannet-1").size());
  ASSERT_FALSE(vessels->With(context).empty());
  EXPECT_TRUE(vessels->With("mmsi").empty());
  vessels->sent.clear();
  tracks_.clear();
  Run(500'000);
  ASSERT_EQ(vessels->With(context).size(), 1U);
  EXPECT_NE(vessels->With(context)[0].find("lost: boat 17"), std::string::npos);
  EXPECT_EQ(vessels->With("targets.lidar:gannet-1").at(0).find("lost"), std::string::npos);
}

}  // namespace
}  // namespace lookout::plotter
