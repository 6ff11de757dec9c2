#include "scale/team.hpp"

#include <algorithm>
#include <array>

namespace pointskin::scale {

void Team::agree(const std::string& failure) const {
  for (const std::vector<char>& of_one : gather(std::vector<char>(failure.begin(), failure.end())))
    if (!of_one.empty()) throw FailedTogether(ErrorCode::over_limit, std::string(of_one.begin(), of_one.end()));
}

std::unique_ptr<Spool> Team::make_spool(const std::string& folder, std::int64_t bytes) const {
  std::unique_ptr<Spool> spool;
  if (is_first()) spool = std::make_unique<Spool>(folder, bytes, is_alone() ? SpoolName::never : SpoolName::when_shown);
  std::unique_ptr<Spool>* const all[] = {&spool};
  share_spools(folder, all);
  return spool;
}

void Team::share_spools(const std::string& folder, std::span<std::unique_ptr<Spool>* const> spools) const {
  if (is_alone()) return;
  struct Shared {
    std::int64_t place = 0, bytes = 0;
    std::array<char, Spool::kNameLength> name{};
  };
  std::vector<Shared> own;
  for (std::size_t i = 0; i < spools.size(); ++i)
    if (const std::unique_ptr<Spool>& spool = *spools[i]) {
      own.push_back({static_cast<std::int64_t>(i), spool->size(), {}});
      std::ranges::copy(spool->show(), own.back().name.begin());
    }
  const std::vector<std::vector<Shared>> all = gather(own);
  for (std::size_t r = 0; r < all.size(); ++r)
    for (const Shared& other : all[r])
      if (static_cast<int>(r) != rank())
        *spools[static_cast<std::size_t>(other.place)] =
            Spool::open(folder, std::string(other.name.data()), other.bytes);
  wait();  // until all have opened them
  for (const Shared& one : own) (*spools[static_cast<std::size_t>(one.place)])->hide();
}

}  // namespace pointskin::scale
