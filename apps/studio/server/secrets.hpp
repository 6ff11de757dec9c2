// Secrets that nobody can guess, and how to compare with one.
#pragma once

#include <string>
#include <string_view>

namespace pointskin::studio::server {

/// 128 random bits of the system as 32 hexadecimal digits. @throws Error internal if the system has none to give
std::string random_secret();

/// Whether both are the same, in a time that does not depend on where they differ. An empty secret is nobody's.
bool same_secret(std::string_view given, std::string_view secret);

}  // namespace pointskin::studio::server
