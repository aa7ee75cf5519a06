// What a program of the standard library takes without kerf.
#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  const std::vector<std::uint8_t> bytes(1000);
  std::printf("%d\n", bytes[999]);
}
