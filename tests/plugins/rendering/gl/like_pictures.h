// For pictures that should look the same.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "plugins/video/image_file.h"
#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {

/// Expects that no more than `max` pixels differ by more than two grey levels. If more do, both pictures are
/// kept, to be looked at.
inline void expectLike(const Picture& wanted, const Picture& found, int max) {
  ASSERT_EQ(wanted.width, found.width);
  ASSERT_EQ(wanted.height, found.height);
  int different = 0;
  for (int y = 0; y < found.height; ++y)
    for (int x = 0; x < found.width; ++x)
      different += largestDifference(pixelAt(wanted, x, y), pixelAt(found, x, y)) > 2;
  if (different <= max) return;
  static int kept = 0;
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test.name()) + "_" + std::to_string(kept++);
  std::replace(name.begin(), name.end(), '/', '_');
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  writePng(folder / (name + "_wanted.png"), wanted);
  writePng(folder / (name + "_found.png"), found);
  ADD_FAILURE() << different << " pixels differ where " << max << " may; the pictures are "
                << folder / (name + "_*.png");
}

}  // namespace weir::rendering
