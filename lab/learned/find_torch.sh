# Sourced: $python is Debian's Python with numpy and torch, installed or only unpacked below build/torch by ./dev test slow. find_torch fails without them.
python=/usr/bin/python3

find_torch() {  # PROJECT_FOLDER
  local unpacked=$1/build/torch
  $python -c 'import numpy, torch' 2>/dev/null && return 0
  export PYTHONPATH=$unpacked/usr/lib/python3/dist-packages
  export LD_LIBRARY_PATH=$unpacked/lib/x86_64-linux-gnu:$unpacked/usr/lib:$unpacked/usr/lib/x86_64-linux-gnu:$unpacked/usr/lib/x86_64-linux-gnu/blas:$unpacked/usr/lib/x86_64-linux-gnu/lapack
  $python -c 'import numpy, torch' 2>/dev/null
}
