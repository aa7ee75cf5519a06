#include "workbench/formats/turn.hpp"

namespace workbench {

// The expansion of the sum is grown term by term (Shewchuk 1997, section 2).
int sign_of_sum(const double (&terms)[6]) {
  double parts[6];  // do not overlap; the largest last
  int count = 0;
  for (double term : terms) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const double sum = term + parts[i], of_part = sum - term;
      const double error = (term - (sum - of_part)) + (parts[i] - of_part);
      if (error != 0.0) parts[kept++] = error;
      term = sum;
    }
    if (term != 0.0) parts[kept++] = term;
    count = kept;
  }
  return count == 0 ? 0 : parts[count - 1] > 0.0 ? 1 : -1;
}

}  // namespace workbench
