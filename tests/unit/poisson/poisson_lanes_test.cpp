// Eight lanes at once give the bits that eight corners, one after another, give.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "core/float8.hpp"
#include "exec/cpu_primitives.hpp"
#include "poisson/divergence_of_bricks.hpp"
#include "poisson/operator.hpp"
#include "poisson/relax_bricks.hpp"
#include "poisson/splat_kernel.hpp"
#include "unit/poisson/small_tree.hpp"

#if PSK_WIDE

namespace pointskin {
namespace {

using Lanes = std::array<float, 8>;

Lanes lanes_of(const Float8& v) {
  Lanes out;
  store8(v, out.data());
  return out;
}

std::uint32_t bits_of(float v) { return std::bit_cast<std::uint32_t>(v); }

const Float8 kFirst = {0, 1, 2, 3, 4, 5, 6, 7};
const Float8 kSecond = {8, 9, 10, 11, 12, 13, 14, 15};

TEST(Float8, LiesHalfWayBetweenTwoBricksAlongEveryAxis) {
  EXPECT_EQ(lanes_of(between<0>(kFirst, kSecond)), (Lanes{4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(lanes_of(between<1>(kFirst, kSecond)), (Lanes{2, 3, 8, 9, 6, 7, 12, 13}));
  EXPECT_EQ(lanes_of(between<2>(kFirst, kSecond)), (Lanes{1, 8, 3, 10, 5, 12, 7, 14}));
}

TEST(Float8, SelectsByBits) {
  EXPECT_EQ(lanes_of(select(mask_of_bits(0b10000101), kFirst, kSecond)), (Lanes{0, 9, 2, 11, 12, 13, 14, 7}));
}

TEST(Float8, LoadsColumns) {
  float rows[32];
  for (int i = 0; i < 32; ++i) rows[i] = static_cast<float>(i);
  Float8 column[4];
  load_columns(rows, column);
  for (int k = 0; k < 4; ++k) {
    const Lanes lanes = lanes_of(column[k]);
    for (std::size_t s = 0; s < 8; ++s) EXPECT_EQ(lanes[s], rows[4 * s + static_cast<std::size_t>(k)]);
  }
}

TEST(SplatKernel, WeighsEightCornersAsItWeighsEachOfThem) {
  test::Random random(5);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3f p{static_cast<float>(random.in(-3, 4)), static_cast<float>(random.in(-3, 4)),
                  static_cast<float>(random.in(-3, 4))};
    const poisson::BrickSample at(p, {0, 0, 0}, 1);
    float one[8];
    Float8 all;
    at.weights<poisson::QuadraticKernel>(one);
    at.weights<poisson::QuadraticKernel>(all);
    for (std::size_t s = 0; s < 8; ++s) ASSERT_EQ(bits_of(one[s]), bits_of(lanes_of(all)[s]));
    ASSERT_EQ(at.reaches<poisson::QuadraticKernel>(), at.reaches_unordered<poisson::QuadraticKernel>());
  }
}

/// Calls check(system, u, before) for random values on a complete level, with the cube's faces, and on an adaptive one,
/// without and with screening. Many cells hold no sample.
template <class Check>
void for_random_levels(const Check& check) {
  for (const int depth : {0, 1, 3, 6})
    for (const float screening : {0.0F, 2.0F, 50.0F}) {
      SCOPED_TRACE("level " + std::to_string(depth) + ", screening " + std::to_string(screening));
      test::Random random(23);
      test::SmallTree tree(depth == 6 ? test::clustered_points(random, 2, 4, 0.02)
                                      : test::clustered_points(random, 30, 3, 0.05, 0, 0.9999999),
                           {}, depth);
      tree.weigh(0.7F, depth);
      const poisson::Screening collapsed = poisson::collapse_samples(tree.ex, tree.tree, tree.samples.view());
      const octree::LevelView& level = tree.view.finest();
      const auto values = [&] {
        std::vector<float> out(static_cast<std::size_t>(level.nodes()));
        for (float& value : out) value = static_cast<float>(random.in(-1, 1));
        return out;
      };
      const std::vector<float> b = values();
      const std::vector<float> u = values();
      check(poisson::LevelSystem{level, b.data(), collapsed.view(depth), screening, poisson::make_axis_rows_f()}, u,
            values());
    }
}

TEST(RelaxBricks, HasTheBitsOfOneCornerAfterAnother) {
  for_random_levels(
      [](const poisson::LevelSystem& system, const std::vector<float>& u, const std::vector<float>& before) {
        for (const float momentum : {0.0F, 0.3F}) {
          const poisson::ChebyshevStep chebyshev{momentum, 1.2F};
          std::vector<float> plain = before;
          std::vector<float> wide = before;
          const auto relax = [&](std::vector<float>& next) {
            return poisson::RelaxBricks{system, chebyshev, u.data(), next.data()};
          };
          exec::run_range_plain(relax(plain), 0, system.level.bricks);
          if (exec::has_wide_vectors()) exec::run_range_wide(relax(wide), 0, system.level.bricks);
          for (std::int64_t n = 0; n < system.level.nodes(); ++n) {
            const auto i = static_cast<std::size_t>(n);
            float expected = before[i];
            if (test::is_unknown(system.level, n)) {
              float value;
              const auto r = poisson::CornerOperator(system, n).residual(u.data(), value);
              expected = value + (1.2F * (r.residual / r.diagonal) + momentum * (value - before[i]));
            }
            ASSERT_EQ(bits_of(plain[i]), bits_of(expected)) << "node " << n;
            if (exec::has_wide_vectors()) {
              ASSERT_EQ(bits_of(wide[i]), bits_of(expected)) << "node " << n;
            }
          }
        }
      });
}

TEST(DivergenceOfBricks, HasTheSameBitsInLanes) {
  for (const int depth : {0, 1, 3, 6}) {
    test::Random random(29);
    test::SmallTree tree(test::clustered_points(random, 30, 3, 0.05, 0, 0.9999999), {}, depth);
    for (int d = 0; d <= depth; ++d) {
      SCOPED_TRACE("level " + std::to_string(d) + " of " + std::to_string(depth));
      const octree::LevelView& level = tree.view.levels[d];
      const auto nodes = static_cast<std::size_t>(level.nodes());
      std::vector<float> v(3 * nodes);
      for (float& value : v) value = static_cast<float>(random.in(-1, 1));
      std::vector<std::uint8_t> counts(static_cast<std::size_t>(level.bricks));
      std::vector<std::uint8_t> finer_counts(static_cast<std::size_t>(d == depth ? 0 : tree.view.levels[d + 1].bricks));
      for (std::uint8_t& c : counts) c = random.below(3) == 0 ? 0 : 1;
      for (std::uint8_t& c : finer_counts) c = random.below(2) == 0 ? 0 : 1;
      const auto axis = [&](std::size_t a) { return ArrayView<float>{v.data() + a * nodes, level.nodes()}; };
      const auto into = [&](std::vector<float>& b, bool all_count) {
        return poisson::Divergence{level,
                                   d == depth ? 0 : tree.view.levels[d + 1].cell_bricks,
                                   {{axis(0), axis(1), axis(2)}},
                                   poisson::make_coefficients(),
                                   {b.data(), level.nodes()},
                                   all_count ? nullptr : counts.data(),
                                   all_count || d == depth ? nullptr : finer_counts.data()};
      };
      for (const bool all_count : {true, false}) {
        std::vector<float> plain(nodes, 1), wide(nodes, 2);
        exec::run_range_plain(poisson::DivergenceOfBricks{into(plain, all_count)}, 0, level.bricks);
        exec::run_range(poisson::DivergenceOfBricks{into(wide, all_count)}, 0, level.bricks);
        for (std::size_t n = 0; n < nodes; ++n) ASSERT_EQ(bits_of(wide[n]), bits_of(plain[n])) << "node " << n;
      }
    }
  }
}

}  // namespace
}  // namespace pointskin

#endif
