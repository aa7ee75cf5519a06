// Embree, which the workbench links, allocates a few bytes when it is loaded and never frees them.
// LeakSanitizer calls this function of the program to learn about such exceptions.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libembree3.so";
}
