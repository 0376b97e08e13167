-- ARGV: worker. It says goodbye.
redis.call('ZREM', key('workers'), ARGV[1])
redis.call('DEL', key('worker', ARGV[1]))
return 1
