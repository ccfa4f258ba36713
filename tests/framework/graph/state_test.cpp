// What nodes and modules declare as their state is what a checkpoint gives back.
#include "framework/graph/state.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

enum class Phase { kRise, kFall };

struct Record {
  std::int64_t count = 0;
  double error = 0;
};

/// An object that has a state of its own.
class Part : public Stateful {
 public:
  State<double> angle{*this, "angle"};
};

class Everything : public Stateful {
 public:
  State<bool> flag{*this, "flag"};
  State<int> count{*this, "count", 7};
  State<std::uint64_t> seed{*this, "seed"};
  State<double> travel{*this, "travel"};
  State<Vec3f> place{*this, "place"};
  State<Phase> phase{*this, "phase"};
  State<Record> record{*this, "record"};
  State<std::mt19937> random{*this, "random"};
  State<std::string> text{*this, "text"};
  State<std::optional<double>> limit{*this, "limit"};
  State<std::optional<std::string>> note{*this, "note"};
  State<std::vector<Vec3f>> marks{*this, "marks"};
  State<std::vector<std::string>> names{*this, "names"};
  State<std::vector<std::optional<float>>> levels{*this, "levels"};
  State<std::vector<std::unique_ptr<Part>>> parts{*this, "parts"};
  State<Array<int>> removed{*this, "removed"};
  State<Array<float>> lazy{*this, "lazy"};
};

using StateMembers = OnDevice;

TEST_P(StateMembers, ComeBackFromACheckpoint) {
  Everything before;
  before.flag = true;
  before.count += 3;
  before.seed = ~std::uint64_t{0};
  before.travel = 0.1;
  before.place = {1, -0.0f, 1e-40f};
  before.phase = Phase::kFall;
  before.record->count = 5;
  before.record->error = 1e-300;
  before.random->seed(3);
  before.random->discard(1001);
  before.text = "Tür";
  before.limit = 2.5;
  before.marks->push_back({1, 2, 3});
  before.names = std::vector<std::string>{"a", "", "ccc"};
  before.levels = std::vector<std::optional<float>>{1.5f, std::nullopt};
  before.parts->push_back(std::make_unique<Part>());
  before.parts.get()[0]->angle = 30;
  before.removed = Array<int>(*device, std::vector<int>{4, 5});
  before.lazy = Array<float>(*device, std::vector<float>{0.5f});
  StateArrays arrays;
  before.saveState(StateWriter(arrays).in("it"));

  // As reset() leaves it.
  Everything after;
  after.text = "other";
  after.note = "a note";
  after.names = std::vector<std::string>{"x"};
  after.parts->push_back(std::make_unique<Part>());
  after.removed = Array<int>(*device, 2);
  const int* place = after.removed->data();
  after.restoreState(StateReader(arrays, device.get()).in("it"));
  EXPECT_TRUE(after.flag.get());
  EXPECT_EQ(after.count.get(), 10);
  EXPECT_EQ(after.seed.get(), ~std::uint64_t{0});
  EXPECT_EQ(after.travel.get(), 0.1);
  EXPECT_EQ(after.place.get(), before.place.get());
  EXPECT_EQ(after.phase.get(), Phase::kFall);
  EXPECT_EQ(after.record->count, 5);
  EXPECT_EQ(after.record->error, 1e-300);
  EXPECT_EQ((*after.random)(), (*before.random)());
  EXPECT_EQ(after.text.get(), "Tür");
  EXPECT_EQ(after.limit.get(), 2.5);
  EXPECT_EQ(after.note.get(), std::nullopt);
  EXPECT_EQ(after.marks.get(), before.marks.get());
  EXPECT_EQ(after.names.get(), before.names.get());
  EXPECT_EQ(after.levels.get(), before.levels.get());
  EXPECT_EQ(after.parts.get()[0]->angle.get(), 30);
  EXPECT_EQ(after.removed->toHost(), (std::vector<int>{4, 5}));
  EXPECT_EQ(after.removed->data(), place) << "others may hold the address since reset()";
  EXPECT_EQ(after.lazy->toHost(), std::vector<float>{0.5f}) << "made on the device of the run";
}

TEST_P(StateMembers, ThatTheCheckpointDoesNotHoldAreNamed) {
  Everything before;
  StateArrays arrays;
  before.saveState(StateWriter(arrays).in("nodes").in("it"));
  arrays.erase("nodes/it/travel");
  Everything after;
  const Error error =
      errorOf([&] { after.restoreState(StateReader(arrays, device.get()).in("nodes").in("it")); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "nodes/it/travel");
  EXPECT_CONTAINS(error.what(), "run the scene from the start");
}

TEST_P(StateMembers, OfAnotherNumberOfPartsAreRefused) {
  Everything before, after;
  StateArrays arrays;
  before.saveState(StateWriter(arrays));
  after.parts->push_back(std::make_unique<Part>());
  const Error error = errorOf([&] { after.restoreState(StateReader(arrays, device.get())); });
  EXPECT_CONTAINS(error.what(), "parts/size");
}

WEIR_ON_EVERY_DEVICE(StateMembers);

/// Has a hook that forgets nothing, because it cannot.
class Hooked : public Stateful {
 public:
  State<int> declared{*this, "declared"};
  int own = 0;
  int seen = 0;
  void save(const StateWriter& to) const override { to.put("own", own); }
  void restore(const StateReader& from) override {
    from.get("own", own);
    seen = declared;
  }
};

TEST(StateMember, IsSavedBesideTheHooksAndIsThereWhenTheyRestore) {
  Hooked before, after;
  before.declared = 3;
  before.own = 4;
  StateArrays arrays;
  before.saveState(StateWriter(arrays));
  after.restoreState(StateReader(arrays));
  EXPECT_EQ(after.declared.get(), 3);
  EXPECT_EQ(after.own, 4);
  EXPECT_EQ(after.seen, 3);
}

struct TakenName : Stateful {
  State<int> a{*this, "a"}, b{*this, "a"};
};
struct PathAsName : Stateful {
  State<int> a{*this, "a/b"};
};

TEST(StateMember, HasANameOfItsOwn) {
  EXPECT_ANY_THROW(TakenName());
  EXPECT_ANY_THROW(PathAsName());
}

}  // namespace
}  // namespace weir::test
