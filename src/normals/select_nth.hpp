// One place of an order, without the rest of it.
#pragma once

#include "core/host_device.hpp"

namespace pointskin::normals {

/// Rearranges values[0..count) so that values[place] is what ascending order has there. @returns it
/// Expects 0 <= place < count. O(count) as a rule, O(count^2) at worst; what is not ordered (NaN) ends it all the same.
/// Source: Hoare, "Algorithm 65: find", Communications of the ACM 4, 1961.
template <class T>
PSK_HD T select_nth(T* values, int count, int place) {
  int first = 0;
  int last = count - 1;
  while (first < last) {
    const T pivot = values[place];
    int i = first;
    int j = last;
    while (i <= j) {
      while (values[i] < pivot) ++i;
      while (pivot < values[j]) --j;
      if (i > j) break;
      const T other = values[i];
      values[i++] = values[j];
      values[j--] = other;
    }
    if (j < place) first = i;
    if (i > place) last = j;
  }
  return values[place];
}

}  // namespace pointskin::normals
