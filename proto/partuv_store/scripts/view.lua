-- ARGV: job id. Returns {fields of the record, place in the line or -1}.
local record = redis.call('HGETALL', key('job', ARGV[1]))
local place = redis.call('ZRANK', key('waiting'), ARGV[1])
return {record, place or -1}
