package lookout;

import java.io.DataInput;
import java.io.IOException;
import lcm.lcm.LCMDataInputStream;

/** Counts of messages, checked before an array is made of them: see guard_counts_java.cmake. */
final class Counts {
  private Counts() {}

  /**
   * @return count
   * @throws IOException when the bytes that are left cannot hold so many elements, of one byte each at least
   */
  static int checked(int count, DataInput bytes) throws IOException {
    boolean is_too_many = bytes instanceof LCMDataInputStream && count > ((LCMDataInputStream) bytes).available();
    if (count < 0 || is_too_many) throw new IOException("a count of " + count + " does not fit");
    return count;
  }
}
