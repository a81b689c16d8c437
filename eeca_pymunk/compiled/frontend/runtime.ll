; Memory of arrays that kernels make: { references, data }, then the data. Arrays never leave an entry point, so that one
; thread counts references. Names are those that numba's code calls.
declare ptr @malloc(i64)
declare void @free(ptr)

; Data begin 16 bytes after the head, at a multiple of 16; null if there is no memory.
define noalias ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %all = add i64 %size, 16
  %wraps = icmp ult i64 %all, %size
  br i1 %wraps, label %full, label %ask
ask:
  %m = call ptr @malloc(i64 %all)
  %none = icmp eq ptr %m, null
  br i1 %none, label %full, label %got
got:
  store i64 1, ptr %m
  ret ptr %m
full:
  ret ptr null
}

define ptr @NRT_MemInfo_data_fast(ptr %m) {
  %data = getelementptr inbounds i8, ptr %m, i64 16
  ret ptr %data
}

define void @NRT_incref(ptr %m) {
  %none = icmp eq ptr %m, null
  br i1 %none, label %done, label %count
count:
  %n = load i64, ptr %m
  %more = add i64 %n, 1
  store i64 %more, ptr %m
  br label %done
done:
  ret void
}

define void @NRT_decref(ptr %m) {
  %none = icmp eq ptr %m, null
  br i1 %none, label %done, label %count
count:
  %n = load i64, ptr %m
  %less = sub i64 %n, 1
  store i64 %less, ptr %m
  %last = icmp eq i64 %less, 0
  br i1 %last, label %release, label %done
release:
  call void @free(ptr %m)
  br label %done
done:
  ret void
}

; reshape(A.size) of an array without gaps, the only reshape of kernels: 0, an error, for any other.
define i32 @numba_attempt_nocopy_reshape(i64 %nd, ptr %dims, ptr %strides, i64 %newnd, ptr %newdims, ptr %newstrides, i64 %itemsize, i32 %fortran) {
  %line = icmp eq i64 %newnd, 1
  br i1 %line, label %flat, label %other
flat:
  store i64 %itemsize, ptr %newstrides
  ret i32 1
other:
  ret i32 0
}
