// Embree, which the workbench links, allocates a few bytes when it is loaded and never gives them back. They
// are not kerf's to free; LeakSanitizer asks every program for such exceptions by this name.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libembree3.so";
}
