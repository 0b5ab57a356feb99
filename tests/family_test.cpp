// tests/family_test.cpp: runs last. The family of p-values is no larger than Sidak's share of the error assumes.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "statistics.hpp"

namespace {

TEST(Family, IsNoLargerThanAssumed) {
    const char* const folder = std::getenv("MICA_P_VALUES");
    ASSERT_TRUE(folder != nullptr) << "run by ctest";
    int count = 0;
    double smallest = 1;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
        std::ifstream notes(file.path());
        for (double p_value; notes >> p_value; ++count) smallest = std::min(smallest, p_value);
    }
    std::printf("%d p-values, the smallest %.3g: as small or smaller once in %.3g families\n", count, smallest,
                1 / statistics::sidak_smallest(smallest, std::max(count, 1)));
    EXPECT_LE(count, statistics::tests_in_family);
}

} // namespace
